// Checks that a solver keeps its contract (solver.h), as far as possible before it solves anything: that its
// declaration is valid, that its constructor reads every parameter, and that it asks only for declared structures. If a
// plug-in breaks the contract, the checks throw a ContractError that names its file. If a built-in solver does, they
// throw std::logic_error, because this is a bug of the program.
#pragma once

#include "algorithms/error.h"
#include "algorithms/solver.h"

#include <exception>
#include <memory>
#include <new>
#include <string>

namespace hausbench {

// Returns the first error in a declaration, and how to correct it. Returns an empty string if there is none.
std::string declaration_error(const SolverInfo& info);

// Checks the declaration of a solver, and then its constructor, by making an instance with the default parameters.
// Skips the constructor if a parameter has no valid default. The constructor may reject the defaults with an
// InputError.
void check_contract(const SolverEntry& entry);

// Makes an instance of the solver, and checks that its constructor reads every parameter and throws only InputError.
// Pass a new Options object, because it remembers which parameters were read.
std::unique_ptr<Solver> make_solver(const SolverEntry& entry, const Options& options);

// Returns solver.needs(scene, queries), after checking that SolverInfo::may_need contains all of these structures.
Needs checked_needs(const SolverEntry& entry, const Solver& solver, const Scene& scene, const QuerySet& queries);

// Thrown if a solver of a plug-in breaks its contract.
class ContractError : public InputError {
public:
    using InputError::InputError;
};

// Throws ContractError if the solver is from a plug-in, and std::logic_error otherwise. The message consists of the
// solver's name and `what`: "solver 'mine' does not read its parameter 'n'".
[[noreturn]] void break_contract(const std::string& solver, const std::string& what);
bool is_of_plugin(const std::string& solver);

// Calls f, which runs a part of a solver that may throw only InputError; `part` is its name, such as "needs()". If the
// solver is from a plug-in, any other exception becomes a ContractError, except std::bad_alloc: a lack of memory is not
// a fault of the solver.
template <class F> void held_to_contract(const std::string& solver, const char* part, F&& f) {
    try {
        f();
    } catch (const InputError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        if (!is_of_plugin(solver)) throw;
        break_contract(solver, std::string(part) + " throws: " + error.what());
    } catch (...) {
        if (!is_of_plugin(solver)) throw;
        break_contract(solver, std::string(part) + " throws something that is not a std::exception");
    }
}

}  // namespace hausbench
