// Reads the bytes as the journal of a run, with a valid checksum for each line. After an outcome is
// added, reading the journal again must find all outcomes.
#include "datasets/hash.h"
#include "harness/run/journal.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

#include <vector>

namespace hausbench::fuzz {
namespace {

std::string with_checksums(std::string_view bytes) {
    std::string journal;
    while (!bytes.empty()) {
        const std::string_view line = bytes.substr(0, bytes.find('\n'));
        const bool whole = line.size() < bytes.size();
        journal += Sha256().add(line.data(), line.size()).hex().substr(0, 16) + " " + std::string(line);
        if (whole) journal += '\n';  // otherwise as if the last write was interrupted
        bytes.remove_prefix(line.size() + (whole ? 1 : 0));
    }
    return journal;
}

void journals(std::string_view bytes) {
    const bool as_it_is = !bytes.empty() && bytes[0] == '!';  // with the checksums in the bytes
    const MemoryFile file(as_it_is ? std::string(bytes.substr(1)) : with_checksums(bytes));
    try {
        std::size_t kept = 0;
        {
            Journal journal(file.path());
            kept = journal.outcomes().size();
            if (kept > 0) journal.append({"again", 0}, Outcome(journal.outcomes().begin()->second));
            kept = journal.outcomes().size();
        }
        const Journal again(file.path());
        expect(again.outcomes().size() == kept, "the journal has lost an outcome");
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(journals)
