#include "datasets/load.h"

#include "algorithms/error.h"
#include "datasets/formats/formats.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <memory>

namespace hausbench {
namespace {

using readers::lower_case;

constexpr std::string_view surface_ending = "surface.toml";

// Returns the ending of a file in lower case, without ".gz" and without the dot.
std::string ending_of(const std::filesystem::path& file) {
    std::filesystem::path base = file.filename();
    if (lower_case(base.extension().string()) == ".gz") base = base.stem();
    if (lower_case(base.string()).ends_with("." + std::string(surface_ending))) return std::string(surface_ending);
    const std::string extension = lower_case(base.extension().string());
    return extension.empty() ? "" : extension.substr(1);
}

// A gzipped file may inflate to `inflation` times its size, and to `inflated_anyway` bytes in any case. gzip shrinks
// numbers to about a tenth; only a repetition of the same bytes, as in a file made to fill the memory, shrinks to a
// thousandth.
constexpr std::size_t inflation = 200, inflated_anyway = std::size_t{1} << 26;

constexpr std::size_t most_to_recognise = std::size_t{1} << 20;  // bytes of a file with an unknown ending

// Returns the file, or `most` bytes of it and a few more, decompressed if it is gzipped (zlib tests the first two
// bytes).
std::string read_all(const std::filesystem::path& file, std::size_t most = std::size_t{1} << 62) {
    errno = 0;
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.c_str(), "rb"), gzclose);
    if (!in) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
    gzbuffer(in.get(), 1 << 16);
    std::string bytes;
    std::vector<char> buffer(1 << 16);
    for (;;) {
        const int count = gzread(in.get(), buffer.data(), static_cast<unsigned>(buffer.size()));
        int code = 0;
        const std::string why = gzerror(in.get(), &code);
        // For a truncated archive gzread returns no error, but gzerror gives a code.
        if (count < 0 || (count == 0 && code != Z_OK)) throw InputError(file.string() + ": cannot be inflated: " + why);
        if (count == 0 || bytes.size() >= most) return bytes;
        bytes.append(buffer.data(), static_cast<std::size_t>(count));
        const z_off_t taken = gzoffset(in.get());  // bytes of the file read so far; -1 if unknown
        if (taken > 0 && bytes.size() > inflated_anyway && bytes.size() / inflation > static_cast<std::size_t>(taken))
            throw InputError(fmt::format(
                "{}: inflates to more than {} times its size, as no mesh does: inflate it yourself if it is sound",
                file.string(), inflation));
    }
}

bool is_one_of(std::string_view ending, const std::vector<std::string_view>& endings) {
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

const Unread* unread_with_ending(std::string_view ending) {
    for (const Unread& kind : unread_formats())
        if (is_one_of(ending, kind.endings)) return &kind;
    return nullptr;
}

std::string refusal(const std::string& name, const Unread& unread) {
    return fmt::format("{}: is {}, which is not read here: {}", name, unread.title, unread.advice);
}

// Throws `error`, or a better one if the file begins like a file of another kind, whatever its ending says. A 3MF or
// AMF file may be a ZIP archive itself. `format` is null if it is not known, and comes from the ending if `by_ending`.
[[noreturn]] void explain(const InputError& error, const std::string& name, const Format* format,
                          std::string_view bytes, bool by_ending = true) {
    const Format* const recognised = recognised_format(bytes);
    if (recognised && recognised != format)
        throw InputError(fmt::format("{}: begins like a file of {}{}: {}{}", name, recognised->title,
                                     format ? fmt::format(", not of {}", format->title) : "",
                                     by_ending ? "rename it to end in ." : "read it as ", recognised->endings[0]));
    const bool may_be_zip = recognised != nullptr || (format && is_one_of("3mf", format->endings)) ||
                            (format && is_one_of("amf", format->endings));
    for (const Unread& kind : unread_formats())
        if (!kind.begins.empty() && bytes.starts_with(kind.begins) && !(may_be_zip && bytes.starts_with("PK")))
            throw InputError(refusal(name, kind));
    const bool marked = bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff");
    if (marked && bytes.substr(0, 64).find('\0') != std::string_view::npos)
        throw InputError(name + ": is text in UTF-16: save it as UTF-8");
    throw error;
}

}  // namespace

bool names_a_file(const std::string& text) {
    const std::string ending = ending_of(text);
    return text.find('/') != std::string::npos || find_format(ending) || unread_with_ending(ending);
}

bool has_columns(const std::filesystem::path& file) {
    const Format* const format = find_format(ending_of(file));
    return format && format->columns;
}

LoadedShape load_file(const std::filesystem::path& file, const LoadOptions& options) {
    std::error_code error;
    const std::string name = file.string();
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) throw InputError(name + ": no such file: check its path");
    if (std::filesystem::is_directory(status)) throw InputError(name + ": is a folder: name a file in it");
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) == 0)
        throw InputError(name + ": is empty: save or fetch it again");
    const std::string kind = options.format.empty() ? ending_of(file) : lower_case(options.format);
    if (kind.empty())
        explain(InputError(fmt::format("{}: has no extension, which tells the format: rename it to the ending of its "
                                       "format, one of {}",
                                       name, known_endings())),
                name, nullptr, read_all(file, most_to_recognise));
    if (kind == surface_ending) return readers::read_surface(file);
    const Format* const format = find_format(kind);
    if (const Unread* unread = format ? nullptr : unread_with_ending(kind)) throw InputError(refusal(name, *unread));
    if (!format)
        explain(InputError(fmt::format(
                    "{}: '{}' is not a format that is read here: convert it, for example with meshio or assimp, to one "
                    "of {}",
                    name, one_line(kind), known_endings())),
                name, nullptr, read_all(file, most_to_recognise));
    if (!options.columns.empty() && !format->columns)
        throw InputError(
            fmt::format("{}: a file of this format has no columns to choose: leave out the columns", name));
    const std::string bytes = read_all(file);
    if (bytes.empty()) throw InputError(name + ": is empty: save or fetch it again");
    readers::Input input{name, bytes, file, kind, options};
    const bool marked = bytes.starts_with("\xef\xbb\xbf") && kind != "stl";  // which may be binary, with any header
    if (marked) input.bytes.remove_prefix(3);
    try {
        return readers::finish(input, format->read(input));
    } catch (const InputError& wrong) {
        explain(wrong, name, format, bytes, options.format.empty());
    }
}

}  // namespace hausbench
