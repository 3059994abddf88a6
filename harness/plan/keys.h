// Lists the keys of experiment files; the reader refuses all others. `python3 -m analysis.schema` writes them into
// docs/experiments.md, and `hausbench list keys` prints them. To add a key, add a line to keys.cpp and the code that
// reads it.
#pragma once

#include <string>
#include <vector>

namespace hausbench {

struct Key {
    std::string name;
    std::string fallback;  // default to show, such as "5" or "all scenes"; empty: none
    std::string meaning;   // one line of Markdown
};

struct KeyTable {
    std::string title;  // name of the table in messages, such as "[[scene]]"; empty: the top level
    std::vector<Key> keys;

    std::vector<std::string> names() const;
};

const KeyTable& top_keys();
const KeyTable& limit_keys();
const KeyTable& scene_keys();
const KeyTable& motion_keys(const std::string& kind);  // `kind`: one of motion_kinds()
const KeyTable& solver_keys();
const KeyTable& claim_keys();

const std::vector<std::string>& motion_kinds();

// Returns all tables of keys, in the order of the documentation.
std::vector<KeyTable> key_tables();

}  // namespace hausbench
