// The contract of a solver as far as it can be checked without a scene or before one is solved: what it declares, what its
// constructor reads, and what it asks for. An error of a plug-in becomes a ContractError that names its file; one of this program is
// a std::logic_error.
#pragma once

#include "algorithms/error.h"
#include "algorithms/solver.h"

#include <exception>
#include <memory>
#include <new>
#include <string>

namespace hausbench {

// What is wrong with what a solver declares, with the remedy; empty if nothing is.
std::string declaration_error(const SolverInfo& info);

// The declaration, and a solver made with its defaults where no parameter is required.
void check_contract(const SolverEntry& entry);

// `options` must not have been read. Its constructor must read each of them, and throw nothing but InputError.
std::unique_ptr<Solver> make_solver(const SolverEntry& entry, const Options& options);

// What the solver asks for, which must be in its may_need.
Needs checked_needs(const SolverEntry& entry, const Solver& solver, const Scene& scene, const QuerySet& queries);

class ContractError : public InputError {
public:
    using InputError::InputError;
};

// Throws ContractError for a solver of a plug-in, else std::logic_error.
[[noreturn]] void break_contract(const std::string& solver, const std::string& what);
bool is_of_plugin(const std::string& solver);

// Calls f, a part of a solver that may throw only InputError; what else a plug-in's throws becomes one.
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
