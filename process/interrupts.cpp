#include "process/interrupts.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>

namespace hausbench {

namespace {

constexpr std::array<int, 2> held_signals = {SIGINT, SIGTERM};

int holders = 0;
std::atomic<int> signal_that_came = 0;  // lock-free, so that a signal handler may write it
std::array<struct sigaction, held_signals.size()> actions_before;

}  // namespace

HoldInterrupts::HoldInterrupts() {
    if (holders++ > 0) return;
    signal_that_came = 0;
    for (std::size_t i = 0; i < held_signals.size(); ++i) {
        ::sigaction(held_signals[i], nullptr, &actions_before[i]);
        if (actions_before[i].sa_handler != SIG_DFL) continue;  // leaves signals that are ignored or handled elsewhere
        struct sigaction action {};
        action.sa_handler = [](int number) { signal_that_came = number; };
        ::sigaction(held_signals[i], &action, nullptr);
    }
}

HoldInterrupts::~HoldInterrupts() {
    if (--holders > 0) return;
    for (std::size_t i = 0; i < held_signals.size(); ++i) {
        if (actions_before[i].sa_handler == SIG_DFL) ::sigaction(held_signals[i], &actions_before[i], nullptr);
    }
    if (const int number = signal_that_came.load()) ::raise(number);
}

bool HoldInterrupts::came() { return signal_that_came != 0; }

void HoldInterrupts::handled() { signal_that_came = 0; }

void HoldInterrupts::deliver() {
    const int number = signal_that_came.load();
    ::signal(number, SIG_DFL);
    ::raise(number);
    std::abort();  // reached only if no signal came, or if it is blocked
}

}  // namespace hausbench
