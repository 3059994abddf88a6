// XML for the readers of 3MF, AMF, Collada and VTK's files, parsed by pugixml, which expands no entities of a DTD and
// opens no other file.
#pragma once

#include <pugixml.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// Returns the name of an element or attribute without the prefix of its namespace: "mesh" for "m:mesh".
std::string_view local_name(const char* name);

// An XML document in memory.
class Xml {
public:
    // Throws InputError, "NAME: line 3: WHY", if `bytes` are not XML, if an element has an attribute twice, or if the root
    // element is not `root`. `what` is the format, for the message.
    Xml(std::string name, std::string_view bytes, std::string_view root, std::string_view what);

    pugi::xml_node root() const { return root_; }

    // Throws InputError: "NAME: line 3: WHY", with the line of the node.
    [[noreturn]] void refuse(pugi::xml_node node, const std::string& why) const;

    // Returns the children with this local name.
    static std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name);
    // Returns the first of them, or a null node.
    static pugi::xml_node child(pugi::xml_node node, std::string_view name);
    // Returns the only one of them, or a null node. Throws InputError if there are two.
    pugi::xml_node only_child(pugi::xml_node node, std::string_view name) const;

    // Returns an attribute as a number. Throws InputError if it is missing or not a number.
    double number(pugi::xml_node node, const char* attribute) const;
    // Returns an attribute as an integer of at least 0. Throws InputError if it is missing or not one.
    std::size_t index(pugi::xml_node node, const char* attribute) const;
    // Returns an attribute as text. Throws InputError if it is missing.
    std::string text(pugi::xml_node node, const char* attribute) const;

    // Returns the text of an element without the texts of its child elements. A comment or CDATA section may stand beside
    // a word, and not inside of it: Throws InputError for "1<!-- -->2", which is 12 to XML and 1 2 to many readers.
    std::string content(pugi::xml_node node) const;

    // Returns the numbers in a text, separated by white space. Throws InputError, with the line of `node`, if a word is
    // not a number.
    std::vector<double> numbers(pugi::xml_node node, std::string_view text) const;

private:
    void check_attributes();

    std::string name_, bytes_;
    pugi::xml_document document_;
    pugi::xml_node root_;
};

}  // namespace hausbench::readers
