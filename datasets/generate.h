// Recipes that generate shapes. They use only +, -, *, / and sqrt, so that the shapes have the same bits on every
// x86-64 machine; a test checks their hashes.
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
    bool required = true;                 // otherwise it may be absent from Numbers
};

inline NumberSpec whole_number(const char* name, double least, double most) { return {name, true, least, most}; }
inline NumberSpec seed_number(const char* name = "seed") { return whole_number(name, 0, 0x1p53); }
inline NumberSpec coordinate(const char* name) { return {name, false, -1e100, 1e100}; }
inline NumberSpec length(const char* name, double least = 1e-100) { return {name, false, least, 1e100}; }

// The input of a recipe: its numbers and, for an operation of derive.h, the shape that it is applied to.
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
    for (const auto& item : list) names.push_back(item.name);
    return names;
}

// Returns the recipe of this name. Throws InputError if there is none; the message begins with `what` ("unknown
// recipe") and has the nearest known name.
const Recipe& find_recipe(const std::vector<Recipe>& list, const std::string& name, const std::string& what);

// All recipes. `hausbench list keys` prints them with their explanations.
const std::vector<Recipe>& recipes();
std::vector<Recipe> point_recipes();  // the recipes for point sets, in point_recipes.cpp

// Throws InputError if a number has a name that the recipe does not know (the message has the nearest known one), if a
// required number is missing, or if a number is out of range or a fraction instead of an integer. Every message begins
// with `where`.
void check_numbers(const std::string& where, const Recipe& recipe, const Numbers& numbers);

// Makes a shape. Requires numbers that passed check_numbers(). Throws InputError for an unknown recipe.
Shape generate(const std::string& recipe, const Numbers& numbers);

}  // namespace hausbench
