// Defers SIGINT (Ctrl-C) and SIGTERM until the code can stop safely.
#pragma once

namespace hausbench {

// While an instance exists, SIGINT (Ctrl-C) and SIGTERM are deferred; poll came() and stop. The last instance to be
// destroyed delivers the signal, unless handled() was called. Create instances on one thread only; any thread may
// call came().
class HoldInterrupts {
public:
    HoldInterrupts();
    ~HoldInterrupts();
    HoldInterrupts(const HoldInterrupts&) = delete;
    HoldInterrupts& operator=(const HoldInterrupts&) = delete;

    static bool came();
    static void handled();  // call it after acting on the signal; it is then not delivered
    // Ends this process by the signal that came, even if other instances exist.
    [[noreturn]] static void deliver();
};

}  // namespace hausbench
