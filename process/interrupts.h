// Defers SIGINT (Ctrl-C) and SIGTERM until the code can stop safely.
#pragma once

namespace hausbench {

// While an instance exists, SIGINT (Ctrl-C) and SIGTERM do not end this process. Poll came(), and stop when it returns
// true. When the last instance is destroyed, a signal that came ends the process after all, unless handled() was
// called. Create instances on one thread only; any thread may call came().
class HoldInterrupts {
public:
    HoldInterrupts();
    ~HoldInterrupts();
    HoldInterrupts(const HoldInterrupts&) = delete;
    HoldInterrupts& operator=(const HoldInterrupts&) = delete;

    static bool came();
    static void handled();  // call it after acting on the signal, which then does not end the process
    // Ends this process with the signal that came, even while instances exist.
    [[noreturn]] static void deliver();
};

}  // namespace hausbench
