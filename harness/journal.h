// What is finished is safe: outcomes appended, each with a checksum and fsync, to a file beside the result.
//
// One line a record: 16 hexadecimal digits of the SHA-256 of the rest, a blank, JSON. A last line that is torn (power cut,
// kill) is cut off when the journal is opened; a damaged line further up is an error, since something else wrote there.
#pragma once

#include "record.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace hausbench {

class Journal {
public:
    // Opens or creates, and locks: throws InputError if another run holds it, if it is damaged, of another schema or not
    // ours, or cannot be written. `fresh`: whatever is in it is forgotten (`run --fresh`), and need not be ours.
    explicit Journal(std::filesystem::path file, bool fresh = false);
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    // Identity and round (see Experiment::rounds); a later record of the same key replaces the earlier.
    using Key = std::pair<std::string, int>;

    const std::map<Key, Outcome>& outcomes() const { return outcomes_; }
    void append(const Key& key, const Outcome& outcome);

    // When the first record was begun, UTC.
    const std::string& started() const { return started_; }

private:
    void write_line(const std::string& text);
    void read();
    bool take(int number, std::string_view text);  // a line; false if it is no record
    void clear();
    void begin();

    std::filesystem::path file_;
    int descriptor_ = -1;
    std::string started_;
    std::map<Key, Outcome> outcomes_;
};

}  // namespace hausbench
