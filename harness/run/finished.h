// The cases of a plan that the journal already answers, with their fields.
#pragma once

#include "plan/plan.h"
#include "run/journal.h"

#include <cstddef>
#include <filesystem>

namespace hausbench {

class Finished {
public:
    // Journal and fields stand in `folder`, in files that begin with `name`. Throws InputError as Journal does. `start_over`: what an
    // earlier run finished of these cases is forgotten.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, bool start_over,
             bool any_build);

    // The answer of a row in a round; null where it has to be run (again).
    const Outcome* kept(std::size_t row, int round) const;
    void append(std::size_t row, int round, const Outcome& outcome);

    // Whether a round has to run the row: it is not there, or lacks its fields, and there is something to time.
    bool is_open(std::size_t row, int round) const;

    // Where the fields of a row belong; empty: it has none.
    std::filesystem::path fields_file(std::size_t row) const;
    bool lacks_fields(std::size_t row, const Outcome& outcome) const;

    // The row with what is known of it: its rounds together, or what it is read off from, and its fields.
    Row row(std::size_t number) const;

    const std::string& started() const { return journal_.started(); }

private:
    bool traces_chain(std::size_t row) const;
    bool is_surface(const std::string& name) const;
    Fields fields_of(std::size_t row, Outcome& outcome) const;
    Outcome gather(std::size_t row) const;
    Outcome read_off(std::size_t row, const FromTrace& from) const;

    const Plan& plan_;
    bool any_build_;
    Journal journal_;
    std::filesystem::path fields_;  // folder
};

}  // namespace hausbench
