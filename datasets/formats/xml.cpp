#include "datasets/formats/xml.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench::readers {

std::string_view local_name(const char* name) {
    const std::string_view whole(name);
    const std::size_t colon = whole.find(':');
    return colon == std::string_view::npos ? whole : whole.substr(colon + 1);
}

Xml::Xml(std::string name, std::string_view bytes, std::string_view root, std::string_view what)
    : name_(std::move(name)), bytes_(bytes) {
    const pugi::xml_parse_result result = document_.load_buffer(bytes_.data(), bytes_.size(), pugi::parse_default);
    if (!result) {
        const auto at = std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), bytes_.size());
        const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
        readers::refuse(name_, static_cast<std::uint32_t>(line),
                        fmt::format("is not XML, as a {} file is: {}", what, result.description()));
    }
    root_ = document_.document_element();
    if (local_name(root_.name()) != root)
        throw InputError(fmt::format("{}: is not a {} file: its root element is <{}>, not <{}>", name_, what,
                                     shown(root_.name()), root));
}

void Xml::refuse(pugi::xml_node node, const std::string& why) const {
    const auto at = std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), bytes_.size());
    const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    readers::refuse(name_, static_cast<std::uint32_t>(line), why);
}

std::vector<pugi::xml_node> Xml::children(pugi::xml_node node, std::string_view name) {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node child : node.children())
        if (local_name(child.name()) == name) found.push_back(child);
    return found;
}

pugi::xml_node Xml::child(pugi::xml_node node, std::string_view name) {
    for (const pugi::xml_node child : node.children())
        if (local_name(child.name()) == name) return child;
    return {};
}

std::string Xml::text(pugi::xml_node node, const char* attribute) const {
    const pugi::xml_attribute found = node.attribute(attribute);
    if (!found) refuse(node, fmt::format("<{}> has no attribute '{}'", shown(node.name()), attribute));
    return found.value();
}

double Xml::number(pugi::xml_node node, const char* attribute) const {
    const std::string value = text(node, attribute);
    const auto number = decimal(trimmed(value));
    if (!number) refuse(node, fmt::format("{}=\"{}\" is not a number", attribute, shown(value)));
    return *number;
}

std::size_t Xml::index(pugi::xml_node node, const char* attribute) const {
    const std::string value = text(node, attribute);
    const auto number = whole<std::size_t>(trimmed(value));
    if (!number) refuse(node, fmt::format("{}=\"{}\" is not an integer of at least 0", attribute, shown(value)));
    return *number;
}

std::vector<double> Xml::numbers(pugi::xml_node node, std::string_view text) const {
    constexpr std::string_view spaces = " \t\r\n\v\f";
    std::vector<double> values;
    for (std::size_t at = text.find_first_not_of(spaces); at != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_of(spaces, at), text.size());
        const auto value = decimal(text.substr(at, end - at));
        if (!value) refuse(node, fmt::format("'{}' is not a number", shown(text.substr(at, end - at))));
        values.push_back(*value);
        at = text.find_first_not_of(spaces, end);
    }
    return values;
}

}  // namespace hausbench::readers
