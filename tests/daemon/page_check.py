#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the live page, `jinkd --page`.

    page_check.py refusals|server|flight|shapes --jinkd PROGRAM [--sim PROGRAM] [--jink PROGRAM] [--viewer live.html]

refusals: command lines that end jinkd with status 2. server: a running jinkd against good, bad, slow and many clients.
flight: a simulated flight in real time; events are held against the simulator's own record, and shown in Chromium.
shapes: the same of obstacles and closed areas, held against the flight log.
"""
import argparse
import contextlib
import json
import math
import os
import pathlib
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOP / "tests/viewer"))
import browser  # noqa: E402
from page_paths import check_decisions, check_nominal, check_paths, distance_to_path  # noqa: E402
from page_shapes import SCENARIO, check_drawn, check_shapes as check_events_of_shapes  # noqa: E402
from page_client import MAX_CLIENTS, MAX_HEAD, PATIENCE, STUB, Hearer, Running, answer, connect, free_port, get, read_all, until  # noqa: E402

# --- refusals

def check_refusals(options):
    def refused(*arguments, names=""):
        done = subprocess.run([options.jinkd, "--serial", "/dev/no_such_line", *map(str, arguments)], capture_output=True, text=True, timeout=20)
        assert done.returncode == 2, f"{arguments}: status {done.returncode}\n{done.stdout}{done.stderr}"
        assert names in done.stderr and "--page" in done.stderr, f"{arguments}: says {done.stderr!r}"

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        stub = folder / "stub.html"
        stub.write_bytes(STUB)
        for text in ("", "0", "65536", "-1", "80x", "x", "8080:", ":8080", "::1:8080", "[::1]", "[::1:8080", "1.2.3:8080", "1.2.3.4.5:8080",
                     "example.org:8080", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:99999999999999999999", " 8080", "8080 "):
            refused("--page", text, "--page-file", stub, names=text)
        refused("--page-file", stub)
        missing, empty, huge, fifo = folder / "missing.html", folder / "empty.html", folder / "huge.html", folder / "fifo.html"
        empty.touch()
        with open(huge, "wb") as file:
            file.truncate((8 << 20) + 1)
        os.mkfifo(fifo)
        for file in (missing, empty, huge, fifo, folder):
            refused("--page", free_port(), "--page-file", file, names=str(file))
        refused("--page", f"192.0.2.1:{free_port()}", "--page-file", stub, names="192.0.2.1")
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            refused("--page", taken.getsockname()[1], "--page-file", stub, names="in use")


# --- server

def check_page(port):
    for host in ("localhost", "LocalHost", f"localhost:{port}", "127.0.0.1", f"127.0.0.1:{port}", f"[::1]:{port}"):
        status, fields, body = answer(port, get("/", host))
        assert status == 200 and body == STUB, f"{host}: {status}, {len(body)} bytes"
    assert fields["cache-control"] == "no-store" and fields["x-content-type-options"] == "nosniff", fields
    policy = fields["content-security-policy"]
    assert "default-src 'none'" in policy and "connect-src 'self'" in policy and "frame-ancestors 'none'" in policy, policy
    assert fields["content-type"].startswith("text/html") and "access-control-allow-origin" not in fields, fields
    with connect(port) as client:  # in pieces of one byte, with an end of the sending side behind them
        for byte in get("/"):
            client.sendall(bytes([byte]))
        client.shutdown(socket.SHUT_WR)
        assert read_all(client).endswith(STUB[-100:])


def check_bad_requests(port):
    filled = b"GET / HTTP/1.1\r\nHost: localhost\r\nX: "
    fit = filled + b"a" * (MAX_HEAD - len(filled) - 4) + b"\r\n\r\n"
    assert len(fit) == MAX_HEAD
    table = [
        (fit, 200), (fit[:-4] + b"a\r\n\r\n", 431), (b"GET / HTTP/1.1\r\nX: " + b"a" * 100_000, 431), (b"a" * 20_000, 431),
        (b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc", 405), (b"HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n", 405),
        (b"OPTIONS * HTTP/1.1\r\nHost: localhost\r\n\r\n", 405), (b"DELETE /events HTTP/1.1\r\nHost: localhost\r\n\r\n", 405),
        (get("/etc/passwd"), 404), (get("/../../etc/passwd"), 404), (get("/%2e%2e/"), 404), (get("//"), 404), (get("/events/"), 404),
        (get("/?x"), 404), (get("http://localhost/"), 404), (get("/Events"), 404),
        (get("/", "evil.example"), 421), (get("/", "localhost.evil.example"), 421), (get("/events", "evil.example:80"), 421),
        (get("/", "127.0.0.1.evil.example"), 421), (get("/", "localhost:80@evil.example"), 421), (get("/", ""), 421), (get("/", "127.0.0.2"), 421),
        (b"GET / HTTP/1.1\r\n\r\n", 400), (b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: localhost\r\nHOST: evil.example\r\n\r\n", 400), (b"GET / HTTP/2.0\r\nHost: localhost\r\n\r\n", 400),
        (b"GET / HTTP/1.1 \r\nHost: localhost\r\n\r\n", 400), (b"GET  / HTTP/1.1\r\nHost: localhost\r\n\r\n", 400),
        (b"GET /\r\nHost: localhost\r\n\r\n", 400), (b"GET\r\n\r\n", 400), (b"\r\n\r\n", 400), (b"\0\0 \0 \0\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost : localhost\r\n\r\n", 400), (b"GET / HTTP/1.1\r\nHost: localhost\r\n folded: x\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: local\0host\r\n\r\n", 400), (b"GET / HTTP/1.1\nHost: localhost\n\r\n\r\n", 400),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 400)]
    for request, expected in table:
        status, fields, body = answer(port, request)
        assert status == expected, f"{request[:80]!r}: {status}, expected {expected}"
        assert expected == 200 or len(body) < 100, f"{request[:80]!r}: {body[:200]!r}"
        assert expected != 405 or fields["allow"] == "GET", fields


def check_random_requests(port, seed):
    """Damaged requests: never an answer that is none of ours, never a 200 to something that is not one of our requests."""
    source = random.Random(seed)
    for _ in range(150):
        request = bytearray(get(source.choice(["/", "/events"]).replace("events", "event")))
        for _ in range(source.randint(1, 4)):
            request[source.randrange(len(request) - 4)] = source.randrange(256)
        request = bytes(request)
        if b"\r\n\r\n" not in request:
            continue
        status, _, _ = answer(port, request)
        assert status in (200, 400, 404, 405, 421), f"seed {seed}: {request!r}: {status}"
        assert status != 200 or (request.startswith((b"GET / HTTP/1.1\r\n", b"GET / HTTP/1.0\r\n")) and b"localhost" in request.lower()), \
            f"seed {seed}: {request!r} was served"


def check_many(port):
    """Eight are served, the ninth is told so; a place that is left is taken again."""
    hearers = []
    until(lambda: answer(port, get("/nothing"))[0] == 404, "no place is free")  # clients of before have gone
    time.sleep(1.2)
    for _ in range(MAX_CLIENTS):
        hearers.append(Hearer(port))
        assert hearers[-1].status == 200 and "text/event-stream" in hearers[-1].head, hearers[-1].head
    with connect(port) as ninth:
        assert read_all(ninth).startswith(b"HTTP/1.1 503"), "a ninth client was served"
    for hearer in hearers:
        first, second = hearer.next(), hearer.next()
        until(lambda: hearer.next()["page"]["clients"] == MAX_CLIENTS, "the page does not count its clients")
        assert second["step"] > first["step"] and second["time"] > first["time"] and first["own"] is None and first["tracks"] == [], (first, second)
    hearers.pop().close()
    until(lambda: answer(port, get("/nothing"))[0] == 404, "the place of one that left is not free")
    for hearer in hearers:
        hearer.close()


def check_rate(hearer):
    began, first = time.monotonic(), hearer.next()
    for _ in range(20):
        last = hearer.next()
    took = last["time"] - first["time"]
    assert 1.5 < took < 3.5, f"20 events in {took} s of jinkd, {time.monotonic() - began} s"
    assert 40 <= last["step"] - first["step"] <= 200, (first, last)


def check_slow(port):
    """One that reads nothing, one that asks nothing and one that talks behind its request are closed and counted; others are served on."""
    witness = Hearer(port)
    slow_before = witness.next()["page"]["slow"]
    slow, silent, talker = connect(port, 2048), connect(port), Hearer(port)
    slow.sendall(get("/events"))
    talker.client.sendall(b"x")
    began = time.monotonic()
    while (state := witness.next())["page"]["slow"] < slow_before + 3:
        assert time.monotonic() - began < PATIENCE, state["page"]
    until(lambda: witness.next()["page"]["clients"] == 1, "the slow one is still there")
    for client in (slow, silent, talker.client, witness.client):
        client.close()


def flood(port, seconds, seed):
    """Connections that send anything and go away at once, some with a reset."""
    source, end, opened = random.Random(seed), time.monotonic() + seconds, 0
    while time.monotonic() < end:
        with socket.socket() as client:
            client.settimeout(1.0)
            try:
                client.connect(("127.0.0.1", port))
                client.sendall(source.choice([b"", get("/"), get("/events"), source.randbytes(source.randrange(1, 3000))]))
                if source.random() < 0.5:
                    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                opened += 1
            except OSError:
                pass
    return opened


def check_address(jinkd):
    """Another address of loopback is a Host too, and no other one is."""
    with tempfile.TemporaryDirectory() as name:
        running = Running(jinkd, pathlib.Path(name), address="127.0.0.2")
        for host, expected in (("127.0.0.2", 200), (f"127.0.0.2:{running.port}", 200), ("localhost", 200), ("127.0.0.1", 200),
                               ("127.0.0.3", 421), ("127.0.0.2.evil.example", 421), ("evil.example", 421), ("", 421)):
            status, _, _ = answer(running.port, get("/", host), "127.0.0.2")
            assert status == expected, f"{host} on 127.0.0.2: {status}, expected {expected}"
        time.sleep(1.5)  # steps that are counted
        running.stop()


def check_server(options):
    check_address(options.jinkd)
    for extra in ([], ["--log", "logs"]):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            extra = [str(folder / e) if e == "logs" else e for e in extra]
            (folder / "logs").mkdir()
            running = Running(options.jinkd, folder, *extra)
            port = running.port
            check_page(port)
            hearer = Hearer(port)
            check_rate(hearer)
            if not extra:
                check_bad_requests(port)
                check_random_requests(port, options.seed)
                hearer.close()
                check_many(port)
                check_slow(port)
                before = running.processor()
                opened = flood(port, 2.0, options.seed)
                assert opened > 20, f"{opened} connections alone"
                assert running.processor() - before < 1.5, f"the flood took {running.processor() - before} s of the processor"
                until(lambda: answer(port, get("/"))[0] == 200, "nothing is served after the flood")
                hearer = Hearer(port)
                assert hearer.next()["page"]["messages_lost"] == 0
            running.stop()
            assert not extra or list((folder / "logs").glob("*.ulg")), "no log beside the page"
            try:
                while True:
                    hearer.next()
            except (EOFError, ConnectionResetError):
                pass


# --- flight

class Listening(threading.Thread):
    """Keeps all events, and the first one that a client hears who comes later: after an event with a decision, or with another key."""

    def __init__(self, port, key):
        super().__init__(daemon=True)
        self.port, self.key, self.events, self.first_of_late = port, key, [], None

    def run(self):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                hearer = Hearer(self.port)
                break
            except OSError:
                time.sleep(0.05)
        try:
            while True:
                self.events.append(hearer.next())
                if self.first_of_late is None and any(e[self.key] for e in self.events[1:-1]):
                    late = Hearer(self.port)
                    self.first_of_late = late.next()
                    late.close()
        except (EOFError, ConnectionResetError):
            pass


def check_events(events, flight):
    path = flight["series"]["position"]
    path = path + [[2 * b - a for a, b in zip(path[-11], path[-1])]]  # jinkd carries its state on for a moment behind the flight's end
    known = [e for e in events if e["own"]]
    assert len(known) > 50, f"{len(known)} of {len(events)} events have an own state"
    steps = [e["step"] for e in events]
    assert all(a < b for a, b in zip(steps, steps[1:])) and all(e["page"]["messages_lost"] == 0 for e in events)
    far = [distance_to_path(path, e["own"]["position"]) for e in known]
    assert max(far) < 1.0, f"{max(far)} m beside the path that was flown"
    for a, b in zip(known, known[1:]):
        seconds = b["time"] - a["time"]
        if 0.05 < seconds < 0.2:
            moved = [(q - p) / seconds for p, q in zip(a["own"]["position"], b["own"]["position"])]
            middle = [(p + q) / 2 for p, q in zip(a["own"]["velocity"], b["own"]["velocity"])]
            assert math.dist(moved, middle) < 2.5, f"at {b['time']} s moved with {moved} m/s, velocity {middle} m/s"
    assert any(e["control"] == "ours" and e["in_control"] and e["command"] for e in known), "control was never jink's"
    assert any(e["control"] == "autopilot" and not e["in_control"] for e in known)
    assert any(e["conflict"] and e["conflict"]["kind"] == "track" and 0 < e["conflict"]["time"] < 60 for e in known)
    assert events[-1]["decisions"] >= 1 and any(e["work"] > 0 for e in known)
    nearest = min(math.dist(e["own"]["position"], t["position"]) - t["radius"] for e in known for t in e["tracks"])
    assert abs(nearest - flight["least"]["surface"]) < 1.0, f"nearest {nearest} m, truly {flight['least']['surface']} m"
    numbers = [t["number"] for e in events for t in e["texts"]]
    texts = [t["text"] for e in events for t in e["texts"]]
    assert any("control" in t for t in texts) and any("new manoeuvre" in t for t in texts), texts
    assert sorted(set(numbers)) == list(range(numbers[0], numbers[-1] + 1)), numbers
    check_decisions(events, flight)
    check_nominal(events, flight)


def check_browser(page, port):
    try:
        page.errors, page.requests = [], []
        page.call("Page.navigate", url=f"http://127.0.0.1:{port}/")
        page.wait_for("Page.loadEventFired")
        until(lambda: page.run("window.jinkLive && jinkLive.flight.own[0].some(x => x === x) && jinkLive.count() > 10"), "the page hears nothing")
        look = ("(() => { const r = jinkLive.replay; r.render(); return [r.canvas.toDataURL(), r.vehicle.position.toArray().join(), "
                "document.querySelectorAll('#charts path.curve').length, document.getElementById('connection').textContent]; })()")
        before = page.run(look)
        until(lambda: page.run("jinkLive.state().tracks.length > 0"), "no track on the page")
        time.sleep(2.0)
        after = page.run(look)
        assert before[0] != after[0] and before[1] != after[1], "the picture does not move"
        assert after[2] >= 3 and "live" in after[3] and "control" in after[3], after[2:]
        assert page.run("document.querySelectorAll('#tracks tr').length") >= 1 and page.run("document.body.classList.contains('stale')") is False
        until(lambda: page.run("(ends => { if (ends) jinkLive.source.close(); return ends; })(jinkLive.flight.decisions.length > 0 && "
                               "jinkLive.state().nominal.length > 0)"), "no decision or no nominal path on the page")
        until(lambda: page.run("document.body.classList.contains('stale')"), "old data look new")
        assert "no data" in page.run("document.getElementById('connection').textContent")
        check_paths(page)
        assert page.errors == [], page.errors
        assert set(page.requests) - {"data:,"} == {f"http://127.0.0.1:{port}/", f"http://127.0.0.1:{port}/events"}, set(page.requests)
    finally:
        page.close()


def check_browser_of_shapes(page, port):
    try:
        page.errors = []
        page.call("Page.navigate", url=f"http://127.0.0.1:{port}/")
        page.wait_for("Page.loadEventFired")
        until(lambda: page.run("(has => { if (has) jinkLive.source.close(); return has; })(window.jinkLive && jinkLive.state() && "
                               "jinkLive.replay.shapes.children.some(c => c.userData.shape.kind !== 'area'))"), "no obstacle on the page")
        check_drawn(page)
        assert page.errors == [], page.errors
    finally:
        page.close()


def fly(options, folder, scenario, key, show, *more):
    """(what is heard, whether the page was shown): a flight in real time against jinkd with a page."""
    port = free_port()
    shows = options.viewer.is_file() and browser.find_chromium() is not None
    stub = folder / "stub.html"
    stub.write_bytes(STUB)
    wrapper = folder / "with_page"
    wrapper.write_text(f"#!/bin/sh\nexec '{options.jinkd}' \"$@\" --page {port} --page-file '{options.viewer if shows else stub}' {' '.join(more)}\n")
    wrapper.chmod(0o755)
    page = browser.Browser() if shows else None  # before the flight, which takes 16 s
    flying = subprocess.Popen([options.sim, "fly", scenario, "--daemon", wrapper, "--out", folder / "out"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
    listening = Listening(port, key)
    listening.start()
    try:
        if shows:
            until(lambda: listening.events, "no event comes")
            show(page, port)
        said, _ = flying.communicate(timeout=120)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(flying.pid, signal.SIGKILL)  # jinkd too: it would go on to read the next flight's line
    listening.join(PATIENCE)
    assert flying.returncode == 0, said
    if not shows:
        print("the page itself was not shown: neither chromium nor the built page")
    return listening


def check_flight(options):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        listening = fly(options, folder, TOP / "tests/scenario/head_on.yaml", "decision", check_browser)
        run = json.loads((folder / "out/run.json").read_text())
        check_events(listening.events, run["flights"][0])
        numbers = [e["decision"]["number"] for e in listening.events if e["decision"]]
        assert listening.first_of_late["decision"]["number"] in numbers, "a new client is not sent the newest decision"


def check_shapes(options):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenario, logs = folder / "shapes.yaml", folder / "logs"
        scenario.write_text(SCENARIO)
        logs.mkdir()
        listening = fly(options, folder, scenario, "shapes", check_browser_of_shapes, "--log", f"'{logs}'")
        subprocess.run([options.jink, "log", "--csv", folder / "tables", sorted(logs.glob("*.ulg"))[0]], check=True, timeout=60)
        check_events_of_shapes(listening.events, folder / "tables")
        assert listening.first_of_late["shapes"]["closed_areas"], "a new client is not sent what is closed"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["refusals", "server", "flight", "shapes"])
    parser.add_argument("--jinkd", type=pathlib.Path, required=True)
    parser.add_argument("--sim", type=pathlib.Path)
    parser.add_argument("--jink", type=pathlib.Path)
    parser.add_argument("--viewer", type=pathlib.Path, default=pathlib.Path("/nonexistent"))
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1 << 31))
    options = parser.parse_args()
    print(f"seed {options.seed}")
    {"refusals": check_refusals, "server": check_server, "flight": check_flight, "shapes": check_shapes}[options.what](options)


if __name__ == "__main__":
    main()
