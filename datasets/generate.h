// Shapes made by recipes that use only + - x / and sqrt, so that the result has the same bits on
// every x86-64; a test checks the hashes.
#pragma once

#include "algorithms/scene.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

using Numbers = std::map<std::string, double>;

// A number that a recipe (or an operation, see derive.h) takes.
struct NumberSpec {
    std::string name;
    bool whole = false;
    double least = -1e300, most = 1e300;  // the allowed range, ends included
    bool required = true;                 // if not required and not given, it is absent from Numbers
};

inline NumberSpec whole_number(const char* name, double least, double most) { return {name, true, least, most}; }
inline NumberSpec seed_number(const char* name = "seed") { return whole_number(name, 0, 0x1p53); }
inline NumberSpec coordinate(const char* name) { return {name, false, -1e100, 1e100}; }
inline NumberSpec length(const char* name, double least = 1e-100) { return {name, false, least, 1e100}; }

// The input of a recipe: its numbers, and for the operations of derive.h also a shape.
struct Given {
    const Numbers& numbers;
    const Shape* origin = nullptr;

    double real(const char* name) const { return numbers.at(name); }
    Index whole(const char* name) const { return static_cast<Index>(numbers.at(name)); }
    std::uint64_t seed(const char* name = "seed") const { return static_cast<std::uint64_t>(numbers.at(name)); }
    Vec3 xyz() const { return {real("x"), real("y"), real("z")}; }
    const Points& points() const { return points_of(*origin); }
};

struct Recipe {
    std::string name, meaning;
    std::vector<NumberSpec> numbers;
    std::function<Shape(const Given&)> make;
};

template <class List> std::vector<std::string> names_of(const List& list) {
    std::vector<std::string> names;
    for (const auto& one : list) names.push_back(one.name);
    return names;
}

// Throws InputError for an unknown name; the message begins with `what` ("unknown recipe") and names the nearest.
const Recipe& find_recipe(const std::vector<Recipe>& list, const std::string& name, const std::string& what);

// `hausbench list keys` explains them.
const std::vector<Recipe>& recipes();
std::vector<Recipe> point_recipes();  // the recipes for points, in point_recipes.cpp

// Throws InputError for an unknown name (names the nearest), a missing one, a fraction where an
// integer is required, or a number out of range. `where` begins every message.
void check_numbers(const std::string& where, const Recipe& recipe, const Numbers& numbers);

// Requires numbers that passed check_numbers(). Throws InputError for an unknown recipe.
Shape generate(const std::string& recipe, const Numbers& numbers);

}  // namespace hausbench
