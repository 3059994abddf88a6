// The tree of nodes of an FBX file, binary or text; private to datasets/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// A value of a node, as it stands in the file. Numbers and arrays are decoded when they are asked for.
struct FbxValue {
    // Binary: the type code of the file (C, B, Z, Y, I, F, D, L, S, R, f, d, l, i, b, c). Text: 'S' a string, 'N' a
    // number or another bare word, 'A' an array.
    char type = 0;
    std::string_view bytes;   // the content; of an array, its elements, perhaps deflated
    std::uint32_t count = 0;  // of the elements of an array
    bool deflated = false;

    bool is_array() const { return type == 'A' || (type >= 'a' && type <= 'z'); }
};

struct FbxNode {
    std::string_view name;
    std::size_t place = 0;  // its line, from 1, in text; its first byte, from 0, in a binary file
    std::vector<FbxValue> values;
    std::vector<FbxNode> children;

    // Returns a value that is a string, or an empty text.
    std::string_view text(std::size_t i) const;
};

class FbxTree {
public:
    // Parses the whole file. Throws InputError, which begins with `name`, for versions other than 7.0 to 7.7 and for a
    // file that is damaged. `bytes` must outlive the tree.
    FbxTree(const std::string& name, std::string_view bytes);

    const FbxNode& root() const { return root_; }

    // Throws InputError: "NAME: line 3: WHY" or "NAME: at byte 3: WHY".
    [[noreturn]] void refuse(const FbxNode& node, const std::string& why) const;

    // Returns the child of a node with this name, or null. Throws InputError if there are two.
    const FbxNode* child(const FbxNode& node, std::string_view name) const;

    // Returns value `i` of a node. Throws InputError if there is no such number.
    double real(const FbxNode& node, std::size_t i) const;
    std::int64_t integer(const FbxNode& node, std::size_t i) const;

    // Returns the array of a node: float32 or float64 numbers, or integers of 32 or 64 bits. Throws InputError if it is
    // damaged, or if all arrays read so far are larger than those of a sound file of this size. That is checked before
    // memory is allocated.
    std::vector<double> reals(const FbxNode& node) const;
    std::vector<std::int64_t> integers(const FbxNode& node) const;
    bool is_float32(const FbxNode& node) const;  // whether its array holds float32 numbers

private:
    const FbxValue& array(const FbxNode& node, std::string_view types) const;
    std::string inflated(const FbxNode& node, const FbxValue& value) const;
    template <class Number, class Parse>
    std::vector<Number> elements(const FbxNode& node, std::string_view types, const Parse& parse) const;
    void check_version(std::int64_t version) const;

    const std::string& name_;
    bool binary_ = false;
    FbxNode root_;
    mutable std::uint64_t budget_;  // bytes that arrays may still inflate to
};

}  // namespace hausbench::readers
