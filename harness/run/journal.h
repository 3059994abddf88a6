// Keeps finished outcomes safe: each is appended, with a checksum and fsync, to a file beside the result.
//
// Each line is a record: 16 hexadecimal digits of the SHA-256 of the rest, a space, and JSON. An incomplete last line,
// after a power cut or a kill, is removed when the journal is opened. A damaged line before the last one is an error,
// because an interrupted write cannot cause it.
#pragma once

#include "harness/record/row.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace hausbench {

class Journal {
public:
    // Opens or creates the file, and locks it. Throws InputError if another run holds the lock, or if the file is
    // damaged, has another schema, is not a journal, or cannot be written. With `start_over`, a file that cannot be
    // read is emptied instead.
    explicit Journal(std::filesystem::path file, bool start_over = false);

    // Reads a file that another run may be writing, without locking or changing it. Skips an incomplete last line; a
    // missing file counts as empty. Throws InputError as above. Nothing may be appended.
    struct ReadOnly {};
    Journal(std::filesystem::path file, ReadOnly);

    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    // Identity of the case and number of the round (Experiment::rounds). A later record with the same key replaces an
    // earlier one.
    using Key = std::pair<std::string, int>;

    const std::map<Key, Outcome>& outcomes() const { return outcomes_; }
    void append(const Key& key, const Outcome& outcome);

    // Forgets the outcomes of these identities in all rounds.
    void forget(const std::set<std::string>& identities);

    // Returns the time at which the run that created the journal started, in UTC.
    const std::string& started() const { return started_; }

private:
    void write_line(const std::string& text);
    void read(bool read_only);
    bool take(int number, std::string_view text);  // reads line `number`; false if it is not a record
    void clear();
    void erase(const std::set<std::string>& identities);
    void begin();

    std::filesystem::path file_;
    int descriptor_ = -1;
    std::string started_;
    std::map<Key, Outcome> outcomes_;
};

}  // namespace hausbench
