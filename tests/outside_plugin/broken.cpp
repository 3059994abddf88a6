// A solver that violates its contract in the way named by the environment variable BROKEN. Without the
// variable, it is correct.
#include <hausbench/plugin.h>
#include <hausbench/structures/octree.h>

#include <unistd.h>

#include <cstdlib>
#include <limits>

using namespace hausbench;

namespace {

bool broken(const std::string& how) {
    const char* chosen = std::getenv("BROKEN");
    return chosen && how == chosen;
}

class Broken final : public Solver {
public:
    explicit Broken(const Options& options) {
        if (broken("exits when made")) std::exit(0);
        if (broken("sleeps when made")) ::sleep(1000);
        const auto badly = [&] { return options.text("how") == "badly"; };
        if (broken("exits when made badly") && badly()) std::exit(0);
        if (broken("sleeps when made badly") && badly()) ::sleep(1000);
        if (broken("reads what is not declared")) (void)options.real("hidden");
        if (broken("reads another type")) (void)options.integer("how");
        if (broken("throws at once")) throw 3;
        if (!broken("leaves unread")) (void)options.text("how");
    }

    ~Broken() override {
        if (broken("exits when destroyed")) ::_exit(0);
    }

    Needs needs(const Scene&, const QuerySet&) const override {
        if (broken("needs more")) return {need<TriangleOctree>(Side::target)};
        return {};
    }

    void prepare(const Scene&, const Prepared& prepared) override {
        if (broken("uses more")) (void)prepared.get<TriangleOctree>(Side::target);
    }

    Result solve(const Query&, State*, Trace&) const override {
        if (broken("throws")) throw std::runtime_error("too hard");
        Result result;
        const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
        if (broken("no number")) result.bounds = {nan, 0}, result.status = Status::converged;
        if (broken("infinite")) result.bounds = {infinity, infinity}, result.status = Status::budget;
        if (broken("negative")) result.bounds = {-2, -1}, result.status = Status::below_floor;
        return result;
    }
};

ParameterSpec parameter(const char* name, ParameterValue value) {
    return {.name = name, .default_value = std::move(value), .unit = "", .paper_value = "", .description = "how"};
}

SolverEntry broken_solver() {
    SolverInfo info;
    info.name = broken("no name") ? "" : broken("known name") ? "guthe" : "broken";
    info.title = broken("no title") ? "" : "Broken";
    info.source.mesh = true;
    info.target.mesh = !broken("no target");
    if (broken("unknown paper")) info.paper = "zhang2071";
    if (broken("exits when made badly") || broken("sleeps when made badly")) info.certified = true;
    if (broken("wrong and certified")) info.certified = true, info.known_wrong = "as printed";
    info.parameters = {parameter("how", std::string("well"))};
    info.parameters[0].choices = {"well", "badly"};
    if (broken("parameter twice")) info.parameters.push_back(info.parameters[0]);
    if (broken("default is no choice")) info.parameters[0].choices = {"badly"};
    if (broken("default outside"))
        info.parameters.push_back(parameter("depth", std::int64_t(9))), info.parameters[1].most = 8;
    if (broken("returns nothing")) return {info, [](const Options&) -> std::unique_ptr<Solver> { return nullptr; }};
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Broken>(options); }};
}

// Does what it is told when the library is loaded, and when the program ends.
const struct AtBothEnds {
    AtBothEnds() {
        if (broken("exits when loaded")) std::exit(0);
        if (broken("crashes when loaded")) std::abort();
        if (broken("sleeps when loaded")) ::sleep(1000);
    }
    ~AtBothEnds() {
        if (broken("exits at the end")) ::_exit(7);
        if (broken("sleeps at the end")) ::sleep(1000);
    }
} at_both_ends;

}  // namespace

HAUSBENCH_PLUGIN(broken_solver())
