// Finds the answers in the journal to cases of a plan, and their fields.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/journal.h"

#include <cstddef>
#include <filesystem>
#include <functional>

namespace hausbench {

// Rules for reusing answers from the journal. By default, an answer must come from this build, on this machine, from a
// run that had the machine to itself.
struct Accepted {
    bool any_build = false;     // accepts every answer, also from other builds and machines
    bool any_machine = false;   // accepts answers of this build from other machines
    bool side_by_side = false;  // accepts answers of runs that shared the machine; their times are not comparable
};

class Finished {
public:
    // Opens the journal NAME.journal in `folder`, where NAME is `name`; fields are in its subfolder NAME.fields. With
    // `start_over`, forgets the answers of earlier runs to the plan's cases. Throws the same errors as Journal.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, bool start_over,
             const Accepted& accepted);

    // Opens the journal for reading only, while another run may be writing it. append() must not be called.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, const Accepted& accepted,
             Journal::ReadOnly);

    // Copies accepted answers, with their fields, from the journal `name` in `folder` to this one, for cases that have
    // no answer here. Throws InputError if that journal cannot be read.
    void take_over(const std::filesystem::path& folder, const std::string& name);

    // Returns the accepted answer to a row in a round. Returns null if the row has to be run, for the first time or
    // again.
    const Outcome* kept(std::size_t row, int round) const;
    void forget(std::size_t row);
    std::size_t forget_those(const std::function<bool(const Row&)>& chosen);  // returns how many rows it forgot
    void append(std::size_t row, int round, const Outcome& outcome);

    // Returns whether a row still has to be run in a round: in round 0, if its answer or its fields are missing; in a
    // later round, if its answer is missing and round 0 gave an answer that can be timed.
    bool is_open(std::size_t row, int round) const;

    // Returns how many cases of a job still have to be run in some round.
    std::size_t open_cases(const Job& job) const;

    // Returns the path of the file for a row's fields. The path is empty if the row has no fields.
    std::filesystem::path fields_file(std::size_t row) const;
    bool lacks_fields(std::size_t row, const Outcome& outcome) const;

    // Returns a row with its fields and its outcome so far, which combines all rounds. The outcome of a row that is not
    // run itself is read off the run of another row (Plan::traced).
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
