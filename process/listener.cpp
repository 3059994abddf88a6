#include "process/listener.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace hausbench {

using std::chrono::steady_clock;

namespace {

constexpr std::chrono::milliseconds turn(20);  // how long to wait for an event before looking at limits and interrupts
constexpr std::chrono::seconds most_delay(5);  // between sending and hearing an event, on a busy machine

}  // namespace

double grace_of(double time_limit) { return std::max(1.0, 0.1 * time_limit); }

void send_event(int events, std::string line) {
    line += '\n';
    for (std::size_t done = 0; done < line.size();) {
        const ssize_t n = ::write(events, line.data() + done, line.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) ::_exit(3);
        done += std::size_t(n);
    }
}

Listener::Listener(Child& child, std::int64_t most_bytes, std::function<bool()> interrupted)
    : child_(child), most_bytes_(most_bytes), interrupted_(std::move(interrupted)) {}

void Listener::allow(double seconds) {
    const std::chrono::duration<double> wait(std::min(seconds, 1e9));  // a clock cannot hold infinity
    deadline_ = steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(wait);
}

Listener::Heard Listener::hear(std::string& event, const std::function<void()>& waiting) {
    for (;;) {
        if (interrupted_()) return Heard::interrupted;
        if (is_too_large()) {
            child_.kill();
            return Heard::too_large;
        }
        switch (child_.listen(turn, event)) {
            case Child::Heard::line:
                if (!late_ && steady_clock::now() - most_delay > deadline_) {
                    child_.kill();
                    late_ = true;
                }
                return Heard::event;
            case Child::Heard::closed:
                if (late_) return Heard::late;
                if (child_.ended_within(std::chrono::seconds(1))) return Heard::closed;
                child_.kill();
                return Heard::silent;
            case Child::Heard::nothing:
                if (steady_clock::now() > deadline_) {
                    child_.kill();
                    return Heard::late;
                }
                if (waiting) waiting();
        }
    }
}

// Looks at most once per turn, no matter how many events the child sends.
bool Listener::is_too_large() {
    if (most_bytes_ == std::numeric_limits<std::int64_t>::max() || steady_clock::now() < next_look_) return false;
    next_look_ = steady_clock::now() + turn;
    return child_.takes_more_than(most_bytes_);
}

}  // namespace hausbench
