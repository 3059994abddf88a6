#include "harness/run/time_left.h"

#include <algorithm>
#include <map>

namespace hausbench {

namespace {

struct Sum {
    double open = 0, ended = 0, took = 0;  // seconds: expected for open and ended cases; actual for ended cases

    void add(const OpenWork& part) {
        open += double(part.open) * part.expected;
        ended += double(part.ended) * part.expected;
        took += part.took;
    }

    // Returns the ratio of the actual to the expected time of the ended cases. Adds one second of imaginary work with
    // the ratio `otherwise`, so that the result stays close to `otherwise` while the ended cases are few and short.
    double times_as_long(double otherwise) const {
        constexpr double seconds = 1;
        return (took + seconds * otherwise) / (ended + seconds);
    }
};

}  // namespace

double seconds_left(const std::vector<OpenWork>& parts, double gone_by) {
    std::map<std::string, Sum> kinds;
    Sum all;
    for (const OpenWork& part : parts) {
        kinds[part.kind].add(part);
        all.add(part);
    }
    double work = 0;
    for (const auto& [kind, sum] : kinds) work += sum.open * sum.times_as_long(all.times_as_long(1));
    const double side_by_side = gone_by > 0 ? std::max(1.0, all.took / gone_by) : 1;
    return work / side_by_side;
}

}  // namespace hausbench
