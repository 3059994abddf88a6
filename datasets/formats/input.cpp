// Opens files that another file refers to.
#include "algorithms/error.h"
#include "datasets/formats/readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace hausbench::readers {

namespace fs = std::filesystem;

std::string Input::beside(const std::string& path, std::uint64_t most) const {
    const auto no = [&](const std::string& why) {
        throw InputError(fmt::format("{}: refers to the file '{}', {}", name, one_line(path.substr(0, 200)), why));
    };
    const fs::path relative(path);
    const bool climbs =
        std::any_of(relative.begin(), relative.end(), [](const fs::path& part) { return part == ".."; });
    if (path.empty() || path.find('\0') != std::string::npos || relative.is_absolute() || climbs)
        no("which is not below its own folder: move both into one folder, and name the file without a path");
    std::error_code error;
    const fs::path folder = fs::canonical(file.has_parent_path() ? file.parent_path() : fs::path("."), error);
    const fs::path target = error ? fs::path() : fs::canonical(folder / relative, error);
    if (error) no("which is not there: put it beside this one");
    const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), target.begin(), target.end());
    if (end != folder.end()) no("which is a link out of its folder: copy the file instead");
    if (!fs::is_regular_file(target, error)) no("which is not a regular file: put the file itself there");
    if (fs::file_size(target, error) > most || error) no(fmt::format("which is larger than {} bytes", most));
    std::ifstream in(target, std::ios::binary);
    if (!in) no("which cannot be read: check its permissions");
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace hausbench::readers
