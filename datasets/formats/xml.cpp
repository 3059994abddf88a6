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
    check_attributes();
    root_ = document_.document_element();
    if (local_name(root_.name()) != root)
        throw InputError(fmt::format("{}: is not a {} file: its root element is <{}>, not <{}>", name_, what,
                                     shown(root_.name()), root));
}

void Xml::check_attributes() {
    struct Walker : pugi::xml_tree_walker {
        explicit Walker(const Xml& xml) : xml_(xml) {}
        bool for_each(pugi::xml_node& node) override {
            names_.clear();
            for (const pugi::xml_attribute attribute : node.attributes()) names_.emplace_back(attribute.name());
            std::sort(names_.begin(), names_.end());
            const auto twice = std::adjacent_find(names_.begin(), names_.end());
            if (twice != names_.end())
                xml_.refuse(node, fmt::format("<{}> has the attribute '{}' twice, which is not XML: remove one of them",
                                              shown(node.name()), shown(*twice)));
            return true;
        }
        const Xml& xml_;
        std::vector<std::string_view> names_;  // of one element; kept to save allocations
    } walker(*this);
    document_.traverse(walker);
}

void Xml::refuse(pugi::xml_node node, const std::string& why) const {
    const auto at = std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), bytes_.size());
    const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    readers::refuse(name_, static_cast<std::uint32_t>(line), why);
}

std::vector<pugi::xml_node> Xml::children(pugi::xml_node node, std::string_view name) {
    std::vector<pugi::xml_node> matches;
    for (const pugi::xml_node child : node.children())
        if (local_name(child.name()) == name) matches.push_back(child);
    return matches;
}

pugi::xml_node Xml::child(pugi::xml_node node, std::string_view name) {
    for (const pugi::xml_node child : node.children())
        if (local_name(child.name()) == name) return child;
    return {};
}

pugi::xml_node Xml::only_child(pugi::xml_node node, std::string_view name) const {
    const auto matches = children(node, name);
    if (matches.size() > 1)
        refuse(matches[1], fmt::format("a second <{}> in one <{}>: remove one of them", name, shown(node.name())));
    return matches.empty() ? pugi::xml_node() : matches[0];
}

std::string Xml::text(pugi::xml_node node, const char* attribute) const {
    const pugi::xml_attribute match = node.attribute(attribute);
    if (!match) refuse(node, fmt::format("<{}> has no attribute '{}'", shown(node.name()), attribute));
    return match.value();
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

std::string Xml::content(pugi::xml_node node) const {
    constexpr std::string_view spaces = " \t\r\n\v\f";
    std::string text;
    for (const pugi::xml_node child : node.children()) {
        if (child.type() != pugi::node_pcdata && child.type() != pugi::node_cdata) continue;
        const std::string_view piece = child.value();
        if (!text.empty() && !piece.empty() && spaces.find(text.back()) == std::string_view::npos &&
            spaces.find(piece.front()) == std::string_view::npos)
            refuse(child,
                   fmt::format("a comment or CDATA section in <{}> ends before '{}' without a blank, and may divide "
                               "a number: remove it",
                               shown(node.name()), shown(piece)));
        text += piece;
    }
    return text;
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
