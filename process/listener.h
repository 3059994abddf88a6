// Listens to a child process within limits. The child sends events: lines on a pipe (Child::listen).
#pragma once

#include "process/child.h"

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

namespace hausbench {

// Returns by how many seconds a process that limits its own time may exceed the limit before it is killed, so that a
// solver that stops a little late can still give its bounds.
double grace_of(double time_limit);

// Sends an event, in the child. If the parent is gone, ends the process with exit code 3.
void send_event(int events, std::string line);

class Listener {
public:
    // The child and its descendants may use up to `most_bytes` of memory. `interrupted` is asked again and again: true
    // ends the listening.
    explicit Listener(
        Child& child, std::int64_t most_bytes = std::numeric_limits<std::int64_t>::max(),
        std::function<bool()> interrupted = [] { return false; });

    // Sets the time limit for the next events, in seconds from now. An event does not change it.
    void allow(double seconds);

    enum class Heard {
        event,
        late,         // no event within the time limit: the child was killed
        too_large,    // the child exceeded its memory limit: it was killed
        closed,       // the child has ended
        silent,       // the child has closed its pipe or sent a line that is too long, but did not end: it was killed
        interrupted,  // the child may still run
    };

    // Waits for an event. Calls `waiting` about fifty times a second. An event that was sent in time counts, even if it
    // is heard late. A child that still sends events five seconds after the limit is killed; what it has sent is heard.
    Heard hear(std::string& event, const std::function<void()>& waiting = {});

private:
    bool is_too_large();

    Child& child_;
    std::int64_t most_bytes_;
    std::function<bool()> interrupted_;
    std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::time_point::max();
    bool late_ = false;                                  // the child was killed while it sent events
    std::chrono::steady_clock::time_point next_look_{};  // when the memory is looked at again
};

}  // namespace hausbench
