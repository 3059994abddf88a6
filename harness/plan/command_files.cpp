#include "harness/plan/command_files.h"

#include "datasets/hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include <unistd.h>

namespace hausbench {
namespace {

namespace fs = std::filesystem;

struct Word {
    std::string text;
    bool first;    // the first word of a command, so the name of a program
    bool plain;    // the shell passes it on unchanged, and it has no placeholder
    bool written;  // follows ">", so the name of an output file
};

struct Line {
    std::vector<Word> words;
    bool certain = true;  // false if there is a word such as `cd`: then a program that is not found may still exist
};

template <std::size_t n> bool is_one_of(const std::string& word, const std::array<std::string_view, n>& list) {
    return std::find(list.begin(), list.end(), word) != list.end();
}

bool is_assignment(const std::string& word) {
    const std::size_t equals = word.find('=');
    return equals != std::string::npos && equals > 0 && word.find('/') > equals;
}

// Returns whether the word after this one names a program, as after "time" or "X=1".
bool goes_on(const std::string& word) {
    constexpr std::array<std::string_view, 12> before = {"!",  "{",     "if",    "then", "elif", "else",
                                                         "do", "while", "until", "exec", "time", "command"};
    return is_one_of(word, before) || is_assignment(word);
}

// Returns whether the shell itself provides this command, so that no executable of that name is required.
bool is_builtin(const std::string& word) {
    constexpr std::array<std::string_view, 34> builtins = {
        ":",    "[",     "bg",      "break", "case", "continue", "done",   "echo",  "esac", "exit",   "false", "fg",
        "fi",   "for",   "getopts", "hash",  "jobs", "kill",     "printf", "pwd",   "read", "return", "set",   "shift",
        "test", "times", "trap",    "true",  "type", "ulimit",   "umask",  "unset", "wait", "}"};
    return is_one_of(word, builtins);
}

// Returns whether this word, such as `cd`, may change which file a later program name leads to.
bool changes_the_search(const std::string& word) {
    constexpr std::array<std::string_view, 6> changing = {".", "alias", "cd", "eval", "export", "local"};
    return is_one_of(word, changing) || word.starts_with("PATH=");
}

// Splits a command line into words as the shell does. Removes quotes, backslashes and comments.
class Splitter {
public:
    explicit Splitter(const std::string& line) : line_(line) {}

    Line split() {
        for (; i_ < line_.size(); ++i_) {
            if (quote_)
                quoted(line_[i_]);
            else
                bare(line_[i_]);
        }
        end_word();
        return std::move(found_);
    }

private:
    char next() const { return i_ + 1 < line_.size() ? line_[i_ + 1] : ' '; }

    void add(char c) {
        if (c == '{' && next() != ' ') word_.plain = false;
        if ((c == '$' || c == '`') && quote_ != '\'') word_.plain = false;
        word_.text += c;
        begun_ = true;
    }

    void quoted(char c) {
        if (c == quote_)
            quote_ = 0;
        else if (c == '\\' && quote_ == '"' && i_ + 1 < line_.size())
            word_.text += line_[++i_];
        else
            add(c);
    }

    void bare(char c) {
        constexpr std::string_view separators = ";|&()\n";
        if (c == '\'' || c == '"') {
            quote_ = c;
            begun_ = true;
        } else if (c == '\\' && i_ + 1 < line_.size()) {
            word_.text += line_[++i_];
            begun_ = true;
        } else if (c == ' ' || c == '\t') {
            end_word();
        } else if (c == '<' || c == '>') {
            end_word();
            redirected_ = true;
            word_.written = c == '>';
            if (next() == '&') ++i_;
        } else if (separators.find(c) != std::string_view::npos) {
            if (c == '(' && next() == ')') found_.certain = false;  // defines a function
            end_word();
            first_ = true;
        } else if (c == '#' && !begun_) {
            i_ = std::min(line_.find('\n', i_), line_.size());
            first_ = true;
        } else {
            if (c == '*' || c == '?' || c == '~') word_.plain = false;
            add(c);
        }
    }

    void end_word() {
        if (!begun_) return;
        word_.first = first_ && !redirected_;
        if (word_.first) {
            first_ = goes_on(word_.text);
            if (changes_the_search(word_.text)) found_.certain = false;
        }
        found_.words.push_back(word_);
        word_ = {"", true, true, false};
        begun_ = redirected_ = false;
    }

    const std::string& line_;
    std::size_t i_ = 0;
    Line found_;
    Word word_{"", true, true, false};
    bool begun_ = false, first_ = true, redirected_ = false;
    char quote_ = 0;
};

std::optional<fs::path> file_at(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error) || ::access(path.c_str(), R_OK) != 0) return std::nullopt;
    return path;
}

std::optional<fs::path> program_at(const std::string& name, const fs::path& folder) {
    if (name.find('/') != std::string::npos) return file_at(folder / name);
    const char* path = std::getenv("PATH");
    std::istringstream places(path ? path : "/usr/local/bin:/usr/bin:/bin");
    for (std::string place; std::getline(places, place, ':');) {
        const fs::path file = folder / place / name;  // an empty place in PATH is `folder`
        if (file_at(file) && ::access(file.c_str(), X_OK) == 0) return file;
    }
    return std::nullopt;
}

std::string nowhere(const std::string& program) {
    if (program.find('/') == std::string::npos)
        return fmt::format("the program '{}' is not in PATH: install it, or write its path in the command", program);
    return fmt::format(
        "the program '{}' does not exist: build it, or mend the path, which counts from the folder of the experiment",
        program);
}

}  // namespace

CommandFiles files_of_command(const std::string& line, const fs::path& folder) {
    const Line split = Splitter(line).split();
    CommandFiles files;
    std::set<std::string> written;
    for (const Word& word : split.words) {
        if (word.written) written.insert(word.text);
    }
    Sha256 hash;
    bool any = false;
    for (const Word& word : split.words) {
        if (!word.plain || word.text.empty() || written.contains(word.text)) continue;
        std::optional<fs::path> file = word.first ? program_at(word.text, folder) : file_at(folder / word.text);
        if (const std::size_t equals = word.text.find('='); !file && equals != std::string::npos)
            file = file_at(folder / word.text.substr(equals + 1));
        if (file) {
            hash.add(sha256_of_file(*file));
            any = true;
        } else if (word.first && split.certain && !goes_on(word.text) && !is_builtin(word.text) &&
                   files.missing.empty()) {
            files.missing = nowhere(word.text);
        }
    }
    if (any) files.sha256 = hash.hex();
    return files;
}

bool ignores_tolerance(const SolverInfo& info, const ParameterMap& options) {
    return info.ignores_tolerance ||
           std::any_of(info.parameters.begin(), info.parameters.end(), [&](const ParameterSpec& spec) {
               const auto at = options.find(spec.name);
               const auto* line = at == options.end() ? nullptr : std::get_if<std::string>(&at->second);
               return info.name == "external" && spec.command && line && line->find("tolerance}") == std::string::npos;
           });
}

}  // namespace hausbench
