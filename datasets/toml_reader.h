// Reads tables of a TOML file key by key. Every message has the file, the line and the key, and
// for a wrong key the nearest known one.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// Throws InputError with file and line.
toml::table parse_toml(const std::filesystem::path& file);

// The replacement for every {} in a table: `text` within strings, and `number` if the string is
// "{}" or "-{}" and stands for a number.
struct Filling {
    std::string text;
    double number = 0;
    std::size_t index = 0;  // position among all fillings
};

// All functions except find() and where() throw InputError if a value has the wrong type or
// range. `otherwise` is the default for a missing key.
class TomlReader {
public:
    // `name` is the table's name in messages, such as "[[scene]]"; `before_line` separates file and line in them.
    TomlReader(std::filesystem::path file, const toml::table& table, std::string name = "",
               std::string before_line = ": line ");

    void fill(const Filling& filling) { filling_ = filling; }
    const std::optional<Filling>& filling() const { return filling_; }

    const toml::node* find(std::string_view key) const;  // null if missing
    const toml::node& required(std::string_view key) const;
    std::string text(std::string_view key) const;
    std::string text(std::string_view key, const std::string& otherwise) const;
    bool flag(std::string_view key, bool otherwise) const;
    int count(std::string_view key, int least, int otherwise) const;    // least .. 1000000
    double number(const toml::node& node, std::string_view key) const;  // finite
    double positive(const toml::node& node, std::string_view key,
                    double most = std::numeric_limits<double>::max()) const;
    double length(std::string_view key, double otherwise) const;  // 0 or more
    // Returns an empty list if the key is missing.
    std::vector<std::string> texts(std::string_view key, std::string_view of = "texts") const;

    // Makes more keys known. A key is also known if one of the functions above asked for it.
    void allow(const std::vector<std::string>& keys) const;
    void refuse_other_keys() const;

    std::string where(const toml::node& node) const;  // "FILE: line 3"
    [[noreturn]] void fail(const toml::node& node, const std::string& what) const;
    [[noreturn]] void fail(const std::string& what) const { fail(table_, what); }

    const std::filesystem::path& file() const { return file_; }
    const toml::table& table() const { return table_; }

private:
    template <class T> T value(std::string_view key, const T& otherwise, const char* what) const;
    std::string filled(std::string text) const;
    void expect_no_nul(const std::string& text, std::string_view key) const;
    std::string in_table() const { return name_.empty() ? "" : " in " + name_; }

    std::filesystem::path file_;
    const toml::table& table_;
    std::string name_, before_line_;
    std::optional<Filling> filling_;
    mutable std::vector<std::string> known_;
};

}  // namespace hausbench
