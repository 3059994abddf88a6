// Lets a copy of this process run code that may end it, crash it or hang it, such as a plug-in.
#pragma once

#include <string>

namespace hausbench {

// Continues in a copy of this process (fork), which returns. This process does not: it passes signals on to the copy,
// waits for its end, and ends with the code that the copy gave to tell_exit_code(). If the copy ends without that, this
// process throws InputError, which names `blamed`; if a signal ended the copy after it came from outside (Ctrl-C), this
// process ends by it, too. In the copy, later calls return at once. This process must have one thread only.
void continue_in_copy(const std::string& blamed);

// In the copy: says that all work is done, before destructors of static objects run. Otherwise does nothing.
void tell_exit_code(int code);

// While it lives, the copy may take `seconds` for what it does; then it is killed, and InputError in the waiting process
// says that `doing` did not end, as in "loading x.so". Without a copy, it does nothing. Does not nest.
class TimeLimited {
public:
    TimeLimited(const std::string& doing, double seconds);
    ~TimeLimited();
    TimeLimited(const TimeLimited&) = delete;
    TimeLimited& operator=(const TimeLimited&) = delete;
};

}  // namespace hausbench
