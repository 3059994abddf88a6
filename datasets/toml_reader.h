// Reads tables of a TOML file key by key. Every error message has the file, the line and the key; for an unknown key,
// it also has the nearest known one.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// Throws InputError, with file and line, if the file cannot be read or is not valid TOML.
toml::table parse_toml(const std::filesystem::path& file);

// The replacement for {} in a table that is read several times, such as a scene with a list of severities: it is read
// once with each of them. In a text, every {} becomes `text`. If a number is expected, the string "{}" means `number`
// and "-{}" means -number.
struct Filling {
    std::string text;
    double number = 0;
    std::size_t index = 0;  // position in the list
};

// A table of a file. The functions that return a value throw InputError if it has the wrong type or range, or if the
// key is missing and the function has no parameter `otherwise`, the default.
class TomlReader {
public:
    // In messages, `name` is the name of the table, such as "[[scene]]", and `before_line` separates the file from the
    // line number.
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
    // Returns a list of strings; empty if the key is missing. `of` is the word for them in messages, such as "names of
    // models".
    std::vector<std::string> texts(std::string_view key, std::string_view of = "texts") const;

    // refuse_other_keys() throws InputError if the table has an unknown key. A key is known if a function above asked
    // for it, or if it was passed to allow().
    void allow(const std::vector<std::string>& keys) const;
    void refuse_other_keys() const;

    std::string where(const toml::node& node) const;  // returns "FILE: line 3"
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
