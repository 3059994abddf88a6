// Checks whether a solver keeps its contract (solver.h), as far as this is possible before it solves anything: its
// declaration, the parameters that its constructor reads, and the structures that it asks for. If a solver of a plug-in
// breaks the contract, the checks throw a ContractError that names the plug-in's file. If a built-in solver does, they
// throw std::logic_error, because this is a bug of the program.
#pragma once

#include "algorithms/error.h"
#include "algorithms/solver.h"

#include <exception>
#include <memory>
#include <new>
#include <string>

namespace hausbench {

// Returns the first error in a declaration and how to correct it; empty if there is none.
std::string declaration_error(const SolverInfo& info);

// Checks the declaration. Then makes an instance with the default parameters to check the constructor, unless some
// parameter has no valid default. The constructor may reject the defaults with an InputError.
void check_contract(const SolverEntry& entry);

// Makes an instance of the solver. Its constructor must read every parameter and may throw only InputError. Pass a
// fresh Options object, because a value that was read before would count as read by the constructor.
std::unique_ptr<Solver> make_solver(const SolverEntry& entry, const Options& options);

// Returns solver.needs(scene, queries). Each of these structures must be declared in SolverInfo::may_need.
Needs checked_needs(const SolverEntry& entry, const Solver& solver, const Scene& scene, const QuerySet& queries);

// Thrown if a solver of a plug-in breaks its contract.
class ContractError : public InputError {
public:
    using InputError::InputError;
};

// Throws ContractError if the solver is from a plug-in, else std::logic_error. The message consists of the solver's
// name and `what`: "solver 'mine' does not read its parameter 'n'".
[[noreturn]] void break_contract(const std::string& solver, const std::string& what);
bool is_of_plugin(const std::string& solver);

// Calls f, which runs a part of a solver that may throw only InputError. `part` names it, for example "needs()". If the
// solver is from a plug-in, another exception becomes a ContractError; only std::bad_alloc is passed on, because a lack
// of memory is not a fault of the solver.
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
