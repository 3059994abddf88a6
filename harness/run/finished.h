// The cases of a plan that the journal already answers, with their fields.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/journal.h"

#include <cstddef>
#include <filesystem>
#include <functional>

namespace hausbench {

// Which answers in the journal are accepted. By default, an answer must come from this build, on this machine, from a
// run that had the machine to itself.
struct Accepted {
    bool any_build = false;     // accepts every answer, also from other builds and machines
    bool any_machine = false;   // accepts answers of this build from other machines
    bool side_by_side = false;  // accepts answers of runs that shared the machine; their times are not comparable
};

class Finished {
public:
    // Opens the journal `folder`/NAME.journal, where NAME is `name`; files of fields are in `folder`/NAME.fields.
    // Throws InputError as Journal does. With `start_over`, forgets the answers of earlier runs to the plan's cases.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, bool start_over,
             const Accepted& accepted);

    // The same for reading only: another run may still be writing the journal. Nothing may be appended.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, const Accepted& accepted,
             Journal::ReadOnly);

    // Copies accepted answers, with their fields, from another journal, for the cases that have no answer here. Its
    // name is formed as above. Throws InputError if it cannot be read.
    void take_over(const std::filesystem::path& folder, const std::string& name);

    // Returns the accepted answer of a row in a round; null if the row has to be run, for the first time or again.
    const Outcome* kept(std::size_t row, int round) const;
    void forget(std::size_t row);
    std::size_t forget_those(const std::function<bool(const Row&)>& chosen);  // returns how many rows it forgot
    void append(std::size_t row, int round, const Outcome& outcome);

    // Returns whether the row still has to be run in this round. Round 0 is open if the answer or its fields are
    // missing. A later round is open if its answer is missing and round 0 gave an answer that can be timed.
    bool is_open(std::size_t row, int round) const;

    // Returns how many cases of a job are open in some round.
    std::size_t open_cases(const Job& job) const;

    // Returns the file for the fields of a row; an empty path if the row has no fields.
    std::filesystem::path fields_file(std::size_t row) const;
    bool lacks_fields(std::size_t row, const Outcome& outcome) const;

    // Returns a row with its fields and its outcome so far: all rounds combined or, for a row that is not run itself,
    // read off the run of another row (Plan::traced).
    Row row(std::size_t number) const;

    const std::string& started() const { return journal_.started(); }

private:
    bool will_do(std::size_t row, const Outcome& outcome) const;  // whether the outcome is accepted
    bool traces_chain(std::size_t row) const;                     // whether a warm row must have a trace
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
