// Defers SIGINT (Ctrl-C) and SIGTERM until the code can stop safely.
#pragma once

namespace hausbench {

// While an instance exists, SIGINT (Ctrl-C) and SIGTERM are deferred; poll came() and stop. The last instance to be
// destroyed delivers the signal, unless somebody said that it is handled. For one thread; came() for all of them.
class HoldInterrupts {
public:
    HoldInterrupts();
    ~HoldInterrupts();
    HoldInterrupts(const HoldInterrupts&) = delete;
    HoldInterrupts& operator=(const HoldInterrupts&) = delete;

    static bool came();
    static void handled();  // it came and was acted on: it is not delivered
    // Ends this process by the signal that came, however many instances there are.
    [[noreturn]] static void deliver();
};

}  // namespace hausbench
