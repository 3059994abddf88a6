// Saves each outcome as soon as it is known, so that an interrupted run can be resumed. Appends it, with a checksum and
// fsync, to a file beside the result.
//
// Each line is a record: 16 hexadecimal digits of the SHA-256 of the rest, a space, and JSON. A power cut or a kill can
// leave an incomplete last line, which is removed when the journal is next opened. A damaged line before the last one
// is an error, because an interrupted write cannot cause it.
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
    // Opens or creates the file, and locks it. Throws InputError if another run holds the lock, or if the file cannot
    // be written or is not a valid journal of this version. With `start_over`, a file that is not valid is emptied
    // instead.
    explicit Journal(std::filesystem::path file, bool start_over = false);

    // Reads a file that another run may be writing, without locking or changing it. Skips an incomplete last line; a
    // missing file counts as empty. Throws InputError if the file is not a valid journal. append() must not be called.
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

    // Forgets the outcomes of the cases with these identities, in all rounds.
    void forget(const std::set<std::string>& identities);

    // Returns the start time, in UTC, of the run that created the journal.
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
