// The column `profile` of a row: the names of an experiment's profiles, joined by commas.
#pragma once

#include <set>
#include <string>

namespace hausbench {

std::set<std::string> profile_names(const std::string& profiles);
std::string joined_profiles(const std::set<std::string>& names);
std::string joined_profiles(const std::string& a, const std::string& b);  // the names of both, each once
bool share_profile(const std::string& a, const std::string& b);           // whether a name is in both

}  // namespace hausbench
