// Implements the functions that Highway's headers expect from Highway's library. They say which instruction sets
// ("targets") the processor has, and which one is in use.
//
// Highway's own library is not linked, because Debian has it only as a shared library, whose initialiser sets up a
// timer with the instruction `rdtscp`. Some virtual machines hide this instruction, and valgrind then ends the program
// before main(). This project does not need the timer.
#undef HWY_SHARED_DEFINE  // makes these functions hidden symbols, so that a plug-in does not export them
#include <hwy/targets.h>

#include <atomic>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#if HWY_ARCH_X86
#include <cpuid.h>
#endif

namespace hwy {
namespace {

std::atomic<std::int64_t> targets_for_test{0};  // 0: SupportedTargets() returns the targets of the processor
ChosenTarget chosen_target;

// Returns the instruction sets that the processor has and the operating system enables, as a bit mask. A target is
// included only if the processor has every feature that the compiler may use for it; Highway lists these features in
// HWY_TARGET_STR_... (hwy/ops/set_macros-inl.h).
std::int64_t targets_of_processor() {
    std::int64_t targets = HWY_ENABLED_BASELINE | HWY_SCALAR | HWY_EMU128;
#if HWY_ARCH_X86
    if (!__builtin_cpu_supports("ssse3")) return targets;
    targets |= HWY_SSSE3;
    if (!__builtin_cpu_supports("sse4.1") || !__builtin_cpu_supports("sse4.2") || !__builtin_cpu_supports("pclmul") ||
        !__builtin_cpu_supports("aes"))
        return targets;
    targets |= HWY_SSE4;
    unsigned a = 0, b = 0, c = 0, d = 0;  // for F16C, for which __builtin_cpu_supports of clang 14 has no name
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi") || !__builtin_cpu_supports("bmi2") ||
        !__builtin_cpu_supports("fma") || __get_cpuid(1, &a, &b, &c, &d) == 0 || (c & bit_F16C) == 0)
        return targets;
    targets |= HWY_AVX2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd"))
        targets |= HWY_AVX3;
#endif
    return targets;
}

}  // namespace

std::int64_t SupportedTargets() {
    const std::int64_t forced = targets_for_test.load();
    return forced != 0 ? forced : targets_of_processor();
}

void SetSupportedTargetsForTest(std::int64_t targets) { targets_for_test.store(targets); }

ChosenTarget& GetChosenTarget() { return chosen_target; }

void Abort(const char* file, int line, const char* format, ...) {
    std::va_list values;
    va_start(values, format);
    std::fprintf(stderr, "%s:%d: ", file, line);
    std::vfprintf(stderr, format, values);
    std::fputc('\n', stderr);
    va_end(values);
    std::abort();
}

}  // namespace hwy
