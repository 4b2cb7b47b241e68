// SPDX-License-Identifier: BSD-3-Clause
// The stream of events of jinkd, taken up again however it ends.

/** After a refusal (503 while all places are taken) [ms]. */
const RETRY = 3000;

/** Gives each event to `take`. A browser repairs a broken connection itself, but gives a refused one up for good. */
export class LiveSource {
  constructor(take, Source = EventSource, later = setTimeout) {
    Object.assign(this, { take, Source, later });
    this.connect();
  }

  connect() {
    const source = this.events = new this.Source("events");
    source.onmessage = (event) => this.take(JSON.parse(event.data));
    source.onerror = () => { if (source.readyState === this.Source.CLOSED) this.later(() => this.connect(), RETRY); };
  }

  close() { this.events.close(); }
}
