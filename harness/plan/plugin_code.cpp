#include "harness/plan/plugin_code.h"

#include "algorithms/contract.h"
#include "algorithms/error.h"
#include "algorithms/plugin.h"
#include "process/child.h"
#include "process/stand_in.h"

#include <fmt/format.h>

#include <unistd.h>

#include <map>
#include <utility>

namespace hausbench {
namespace {

constexpr double seconds_to_load = 30, seconds_to_make = 10;
constexpr char yes = '+', no = '-', refused = '!';  // the first character of the child's answer

bool promises_here(const SolverEntry& entry, const ParameterMap& given) {
    return make_solver(entry, Options(entry.info.name, entry.info.parameters, given))->certified();
}

std::string answer_of_child(const SolverEntry& entry, const ParameterMap& given) {
    Launch launch;
    launch.silent = true;
    launch.work = [&](int events) {
        std::string answer;
        try {
            answer = promises_here(entry, given) ? yes : no;
        } catch (const std::exception& error) {
            answer = refused + one_line(error.what());
        } catch (...) {
            answer = no;
        }
        answer += '\n';
        return ::write(events, answer.data(), answer.size()) == ssize_t(answer.size()) ? 0 : 1;
    };
    Child child(std::move(launch));
    std::string answer;
    const bool came =
        child.listen(std::chrono::milliseconds(int(1000 * seconds_to_make)), answer) == Child::Heard::line;
    child.kill();
    return came && !answer.empty() ? answer : std::string(1, no);
}

}  // namespace

void load_plugin_in_copy(const std::filesystem::path& file) {
    continue_in_copy(file.string());
    const TimeLimited limited(fmt::format("loading {}", file.string()), seconds_to_load);
    load_plugin(file);
}

bool promises(const SolverEntry& entry, const ParameterMap& given) {
    if (!entry.info.certified) return false;
    if (!plugin_of(entry.info.name)) return promises_here(entry, given);
    static std::map<std::pair<std::string, ParameterMap>, std::string> answers;
    auto [at, fresh] = answers.try_emplace({entry.info.name, given});
    if (fresh) at->second = answer_of_child(entry, given);
    if (at->second.front() == refused) throw InputError(at->second.substr(1));
    return at->second.front() == yes;
}

}  // namespace hausbench
