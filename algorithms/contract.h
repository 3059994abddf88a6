// Checks of a solver's contract that need no solved scene: its declaration, the parameters its constructor reads, and the
// structures it asks for. A violation by a plug-in throws a ContractError that names its file; one by a built-in solver
// throws a std::logic_error.
#pragma once

#include "algorithms/error.h"
#include "algorithms/solver.h"

#include <exception>
#include <memory>
#include <new>
#include <string>

namespace hausbench {

// Returns the first error in a declaration, with its remedy; empty if there is none.
std::string declaration_error(const SolverInfo& info);

// Checks the declaration and, if no parameter is required, makes a solver with the defaults.
void check_contract(const SolverEntry& entry);

// Makes a solver. `options` must be unread; the constructor must read each of them and may throw only InputError.
std::unique_ptr<Solver> make_solver(const SolverEntry& entry, const Options& options);

// Returns the structures that the solver needs; each must be in its may_need.
Needs checked_needs(const SolverEntry& entry, const Solver& solver, const Scene& scene, const QuerySet& queries);

class ContractError : public InputError {
public:
    using InputError::InputError;
};

// Throws ContractError for the solver of a plug-in, else std::logic_error.
[[noreturn]] void break_contract(const std::string& solver, const std::string& what);
bool is_of_plugin(const std::string& solver);

// Calls f, a part of a solver that may throw only InputError. Other exceptions from a plug-in become ContractErrors.
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
