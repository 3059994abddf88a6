#include "harness/record/profiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace hausbench {

std::set<std::string> profile_names(const std::string& profiles) {
    std::set<std::string> names;
    std::istringstream in(profiles);
    for (std::string name; std::getline(in, name, ',');) names.insert(name);
    return names;
}

bool share_profile(const std::string& a, const std::string& b) {
    const std::set<std::string> names = profile_names(a);
    return std::any_of(names.begin(), names.end(),
                       [others = profile_names(b)](const auto& n) { return others.contains(n); });
}

std::string joined_profiles(const std::set<std::string>& names) { return fmt::format("{}", fmt::join(names, ",")); }

std::string joined_profiles(const std::string& a, const std::string& b) {
    std::set<std::string> names = profile_names(a);
    names.merge(profile_names(b));
    return joined_profiles(names);
}

}  // namespace hausbench
