// The cases of a plan that the journal already answers, with their fields.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/journal.h"

#include <cstddef>
#include <filesystem>
#include <functional>

namespace hausbench {

// Which answers are accepted in addition to answers of this build, on this machine, running alone on it.
struct Accepted {
    bool any_build = false;     // from any build and machine
    bool any_machine = false;   // from this build on any machine
    bool side_by_side = false;  // from runs that shared the machine, so that their times are not comparable
};

class Finished {
public:
    // Opens the journal and the fields, which are in `folder` under names that begin with `name`. Throws InputError
    // as Journal does. With `start_over`, forgets the answers that an earlier run found for the cases of the plan.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, bool start_over,
             const Accepted& accepted);

    // Reads the answers of a run that may still be going on; nothing may be appended.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, const Accepted& accepted,
             Journal::ReadOnly);

    // Copies acceptable answers, with their fields, from another journal for the cases that have no answer here.
    // Throws InputError if that journal cannot be read.
    void take_over(const std::filesystem::path& folder, const std::string& name);

    // Returns the answer of a row in a round; null if it has to be run (again).
    const Outcome* kept(std::size_t row, int round) const;
    void forget(std::size_t row);
    std::size_t forget_those(const std::function<bool(const Row&)>& chosen);  // returns how many
    void append(std::size_t row, int round, const Outcome& outcome);

    // Returns whether a round has to run the row: round 0 if the answer or its fields are missing, a later round if
    // its answer is missing and round 0 gave something to time.
    bool is_open(std::size_t row, int round) const;

    // Returns how many cases of a job still have to run in some round.
    std::size_t open_cases(const Job& job) const;

    // Returns the file for the fields of a row; empty if the row has none.
    std::filesystem::path fields_file(std::size_t row) const;
    bool lacks_fields(std::size_t row, const Outcome& outcome) const;

    // Returns the row with its outcome so far (all rounds combined, or read off the row that it depends on) and its
    // fields.
    Row row(std::size_t number) const;

    const std::string& started() const { return journal_.started(); }

private:
    bool will_do(std::size_t row, const Outcome& outcome) const;
    bool traces_chain(std::size_t row) const;
    bool is_surface(const std::string& name) const;
    Fields fields_of(std::size_t row, Outcome& outcome) const;
    Outcome gather(std::size_t row) const;
    Outcome read_off(std::size_t row, const FromTrace& from) const;

    const Plan& plan_;
    Accepted accepted_;
    Journal journal_;
    std::filesystem::path fields_;  // folder
};

}  // namespace hausbench
