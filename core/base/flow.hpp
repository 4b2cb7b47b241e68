// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink {

/// A flow of control of its own for work that goes on over several steps: it runs when it is resumed, until it pauses
/// or ends. Cooperative: the order of all work is the same in every run. app::FiberFlow is one.
class Flow {
public:
    using Run = void (*)(void* argument) noexcept;

    /// From the next `resume` on `run(argument)` runs. What ran before and has not ended is dropped where it paused:
    /// no destructor of its objects is called. Not from within the flow.
    virtual void begin(Run run, void* argument) noexcept = 0;
    /// Runs until `pause` or the end; nothing where nothing has begun. Not from within the flow.
    virtual void resume() noexcept = 0;
    /// Back to `resume`; returns in the next `resume`. From within the flow alone.
    virtual void pause() noexcept = 0;
    /// Drops what runs. Not from within the flow.
    virtual void drop() noexcept = 0;
    /// Whether something has begun and not ended.
    [[nodiscard]] virtual bool runs() const noexcept = 0;

protected:
    Flow() = default;
    Flow(const Flow&) = default;
    Flow& operator=(const Flow&) = default;
    ~Flow() = default;
};

}  // namespace jink
