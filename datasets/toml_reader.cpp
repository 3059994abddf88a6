#include "datasets/toml_reader.h"

#include "algorithms/error.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hausbench {

toml::table parse_toml(const std::filesystem::path& file) {
    expect_no_device(file);
    try {
        return toml::parse_file(file.string());
    } catch (const toml::parse_error& error) {
        throw InputError(
            one_line(fmt::format("{}: line {}: {}", file.string(), error.source().begin.line, error.description())));
    }
}

TomlReader::TomlReader(std::filesystem::path file, const toml::table& table, std::string name, std::string before_line)
    : file_(std::move(file)), table_(table), name_(std::move(name)), before_line_(std::move(before_line)) {}

std::string TomlReader::where(const toml::node& node) const {
    return fmt::format("{}{}{}", file_.string(), before_line_, node.source().begin.line);
}

void TomlReader::fail(const toml::node& node, const std::string& what) const {
    throw InputError(one_line(where(node) + ": " + what));  // it may quote a key or a string with line breaks
}

const toml::node* TomlReader::find(std::string_view key) const {
    allow({std::string(key)});
    return table_.get(key);
}

const toml::node& TomlReader::required(std::string_view key) const {
    const toml::node* node = find(key);
    if (!node) fail(fmt::format("'{}' is missing{}", key, in_table()));
    return *node;
}

void TomlReader::allow(const std::vector<std::string>& keys) const {
    for (const std::string& key : keys)
        if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
}

void TomlReader::refuse_other_keys() const {
    for (const auto& [key, node] : table_)
        if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
            fail(node, fmt::format("unknown key '{}'{}{}", key.str(), in_table(), nearest_hint(key.str(), known_)));
}

template <class T> T TomlReader::value(std::string_view key, const T& otherwise, const char* what) const {
    const toml::node* node = find(key);
    if (!node) return otherwise;
    const auto value = node->value_exact<T>();
    if (!value) fail(*node, fmt::format("'{}' must be {}", key, what));
    return *value;
}

std::string TomlReader::filled(std::string text) const {
    if (!filling_) return text;
    for (std::size_t at = text.find("{}"); at != std::string::npos; at = text.find("{}", at + filling_->text.size()))
        text.replace(at, 2, filling_->text);
    return text;
}

std::string TomlReader::text(std::string_view key, const std::string& otherwise) const {
    const std::string text = value(key, otherwise, "a text in quotes");
    expect_no_nul(text, key);
    return filled(text);
}

// Refuses NUL, because result files and system calls end a string there.
void TomlReader::expect_no_nul(const std::string& text, std::string_view key) const {
    if (text.find('\0') != std::string::npos)
        fail(required(key), fmt::format("'{}' holds the character NUL (\\u0000): remove it", key));
}

std::string TomlReader::text(std::string_view key) const {
    required(key);
    return text(key, "");
}

bool TomlReader::flag(std::string_view key, bool otherwise) const { return value(key, otherwise, "true or false"); }

int TomlReader::count(std::string_view key, int least, int otherwise) const {
    constexpr int most = 1'000'000;
    const toml::node* node = find(key);
    if (!node) return otherwise;
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < least || *value > most)
        fail(*node, fmt::format("'{}' must be an integer from {} to {}", key, least, most));
    return int(*value);
}

double TomlReader::number(const toml::node& node, std::string_view key) const {
    if (filling_ && node.is_string()) {
        const std::string& text = node.as_string()->get();
        if (text == "{}") return filling_->number;
        if (text == "-{}") return -filling_->number;
    }
    if (!filling_ && (node.value_exact<std::string>() == "{}" || node.value_exact<std::string>() == "-{}"))
        fail(node, fmt::format("'{}' must be a number: {{}} stands for one in a scene with a list of severities", key));
    if (!node.is_number()) fail(node, fmt::format("'{}' must be a number", key));
    const auto integer = node.value_exact<std::int64_t>();
    const auto value = integer ? std::optional(double(*integer)) : node.value<double>();
    if (integer && static_cast<long double>(*value) != static_cast<long double>(*integer))
        fail(node, fmt::format("'{}' is {}, which is not a double: write {:.17g}", key, *integer, *value));
    if (!value || !std::isfinite(*value)) fail(node, fmt::format("'{}' must be a finite number", key));
    return *value;
}

double TomlReader::positive(const toml::node& node, std::string_view key, double most) const {
    const double value = number(node, key);
    if (!(value > 0)) fail(node, fmt::format("'{}' must be above 0, not {}", key, value));
    if (value > most) fail(node, fmt::format("'{}' must be at most {}, not {}", key, most, value));
    return value;
}

double TomlReader::length(std::string_view key, double otherwise) const {
    const toml::node* node = find(key);
    if (!node) return otherwise;
    const double value = number(*node, key);
    if (value < 0) fail(*node, fmt::format("'{}' must be at least 0, not {}", key, value));
    return value;
}

std::vector<std::string> TomlReader::texts(std::string_view key, std::string_view of) const {
    std::vector<std::string> values;
    const toml::node* node = find(key);
    if (!node) return values;
    const toml::array* array = node->as_array();
    if (!array) fail(*node, fmt::format("'{}' must be a list of {}", key, of));
    for (const toml::node& item : *array) {
        const auto value = item.value_exact<std::string>();
        if (!value) fail(item, fmt::format("'{}' must be a list of {}", key, of));
        expect_no_nul(*value, key);
        values.push_back(filled(*value));
    }
    return values;
}

}  // namespace hausbench
