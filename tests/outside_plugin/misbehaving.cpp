// Solvers that crash, hang or lie at one pose, and answer like vertex_only at all others. The harness
// must still write a row for each case.
#include <hausbench/plugin.h>

#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

using namespace hausbench;

SolverEntry vertex_only_solver();  // vertex_only.cpp
SolverEntry spending_solver();     // spending.cpp
SolverEntry steps_solver();        // steps.cpp

namespace {

void crash(const std::string&, Result&) {
    std::fputs("about to touch what is not ours\n", stderr);
    std::raise(SIGSEGV);
}

void hang(const std::string&, Result&) {
    for (;;) ::getppid();  // busy
}

void eat_memory(const std::string& how, Result&) {
    for (std::vector<std::vector<char>> eaten;;) {
        if (how == "at once") eaten.emplace_back(std::size_t(1) << 62);  // std::bad_alloc
        eaten.emplace_back(std::size_t(4) << 20, 'x');
    }
}

void leave(const std::string&, Result&) { ::_exit(0); }

// Leaks 4 MB at each call, or 1.2 GB at once while it writes text to stderr.
void leak(const std::string& how, Result&) {
    static std::vector<std::vector<char>> kept;
    const auto grow = [] { kept.emplace_back(std::size_t(4) << 20, 'x'); };
    const std::string words(std::size_t(1) << 16, '.');
    if (how == "from repeat to repeat") grow();
    if (how == "while it talks") {
        for (int i = 0; i < 300; ++i) grow(), std::fwrite(words.data(), 1, words.size(), stderr);
    }
}

void lie(const std::string& how, Result& result) {
    Bounds& bounds = result.bounds;
    if (how == "upper below") bounds = {0, 0.5 * bounds.lower};
    if (how == "lower above") bounds = {2 * bounds.lower, 2 * bounds.upper};  // the witness is still true
    if (how == "far witness") bounds = {2 * bounds.lower, 2 * bounds.upper}, result.witness.source_point.array() += 100;
    if (how == "no such element") result.witness.source_element = 1000000;
    if (how == "crossed") std::swap(bounds.lower, bounds.upper), bounds.lower *= 1.5;
    if (how == "not a number") bounds.lower = bounds.upper = std::numeric_limits<double>::quiet_NaN();
    result.status = Status::converged;
    if (how == "wide") bounds = {0, 4e9};
    if (how == "false proof") {
        for (Certificate& certificate : result.certificates) certificate.proven *= 0.5;
    }
    if (how == "wide, no cutoff") bounds = {0, 4e9}, result.status = Status::above_cutoff;
}

int event_pipe() {
    std::ifstream in("/proc/self/cmdline");
    const std::string all{std::istreambuf_iterator<char>(in), {}};
    const std::string option("--events\0", 9);
    const std::size_t at = all.find(option);
    return at == std::string::npos ? -1 : std::atoi(all.c_str() + at + option.size());
}

void babble(const std::string& how, Result&) {
    const int pipe = event_pipe();
    if (pipe < 0) return;
    const auto say = [&](const std::string& text) { return ::write(pipe, text.data(), text.size()) >= 0; };
    if (how == "noise") say("\xff\x00 { not an event\n");
    if (how == "json") say("{\"event\": 3}\n[1, 2]\n\"begin\"\n");
    if (how == "another row") say("{\"event\": \"begin\", \"row\": 123456789}\n");
    if (how == "an answer") say("{\"event\": \"answer\", \"row\": 0, \"outcome\": {\"status\": \"ok\"}}\n");
    if (how == "closed") {
        ::close(pipe);
        for (;;) ::pause();
    }
}

void throw_it(const std::string& how, Result&) {
    if (how == "a number") throw 7;
    throw std::runtime_error("it was\ntoo hard");
}

void chatter(const std::string&, Result&) {
    const std::string line(999, '.');
    for (int i = 0; i < 20000; ++i) {
        std::puts(line.c_str());
        std::fprintf(stderr, "%s\n", line.c_str());
    }
}

void tell(const std::string&, Result& result) {
    for (int i = 0; i < 300'000; ++i) result.reported["fact " + std::to_string(i)] = "word";
}

// Reports a time limit after one second.
void dawdle(const std::string&, Result& result) {
    ::usleep(999'999);
    result.status = Status::time_limit;
}

// Not written in the class template below, where GCC 14 does not compile the empty map: it uses a function of <type_traits> before its definition.
std::unique_ptr<Solver> vertex_only() { return vertex_only_solver().make(Options("vertex_only", {}, {})); }

using Deed = void (*)(const std::string& how, Result& result);

template <Deed deed> class Misbehaving final : public Solver {
public:
    explicit Misbehaving(const Options& options)
        : at_(options.real("at")), how_(options.text("how")), good_(vertex_only()) {}

    void prepare(const Scene& scene, const Prepared& prepared) override { good_->prepare(scene, prepared); }

    std::unique_ptr<State> begin() const override { return std::make_unique<State>(); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        Result result = good_->solve(query, nullptr, trace);
        const double x = query.source_pose.translation.x();
        if (how_ == "up to there" ? x <= at_ : x == at_) deed(how_, result);
        return result;
    }

private:
    double at_;
    std::string how_;
    std::unique_ptr<Solver> good_;
};

template <Deed deed> SolverEntry misbehaving(const std::string& name, std::vector<std::string> ways = {""}) {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = name;
    info.certified = false;
    info.abilities.insert(Ability::warm);  // not implemented
    info.original_coordinates = true;      // so that `at` is not rescaled
    info.parameters = {
        {.name = "at",
         .default_value = 1.0,
         .unit = "length",
         .paper_value = "",
         .description = "x of the translation where it misbehaves"},
        {.name = "how",
         .default_value = ways.front(),
         .unit = "",
         .paper_value = "",
         .description = "which way",
         .choices = ways},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> {
                return std::make_unique<Misbehaving<deed>>(options);
            }};
}

// A solver that knows its answer, shows it to whoever watches, and never returns.
class NeverReturns final : public Solver {
public:
    explicit NeverReturns(const Options&) : good_(vertex_only()) {}

    void prepare(const Scene& scene, const Prepared& prepared) override { good_->prepare(scene, prepared); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Bounds bounds = good_->solve(query, nullptr, trace).bounds;
        for (;; ::usleep(10'000)) trace.record(0.5 * bounds.lower, 2 * bounds.upper);
    }

private:
    std::unique_ptr<Solver> good_;
};

SolverEntry never_returns() {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = "never_returns";
    info.abilities.insert(Ability::traces);
    return {info, make_solver<NeverReturns>};
}

// A solver that answers its first query, and no other.
class AnswersOnce final : public Solver {
public:
    explicit AnswersOnce(const Options&) : good_(vertex_only()) {}

    void prepare(const Scene& scene, const Prepared& prepared) override { good_->prepare(scene, prepared); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        static bool answered = false;
        if (answered) hang("", *std::make_unique<Result>());
        answered = true;
        return good_->solve(query, nullptr, trace);
    }

private:
    std::unique_ptr<Solver> good_;
};

SolverEntry answers_once() {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = "answers_once";
    return {info, make_solver<AnswersOnce>};
}

// A solver that shows bounds without a pause, good ones in turn with impossible ones, and never returns.
class Floods final : public Solver {
public:
    explicit Floods(const Options&) : good_(vertex_only()) {}

    void prepare(const Scene& scene, const Prepared& prepared) override { good_->prepare(scene, prepared); }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Bounds bounds = good_->solve(query, nullptr, trace).bounds;
        for (;;) {
            trace.show(0.5 * bounds.lower, 2 * bounds.upper);
            trace.show(2 * bounds.upper, 0.5 * bounds.lower);
            trace.show(std::nan(""), std::nan(""));
        }
    }

private:
    std::unique_ptr<Solver> good_;
};

SolverEntry floods() {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = "floods";
    info.abilities.insert(Ability::traces);
    return {info, make_solver<Floods>};
}

// A solver that runs out of time if the target has more triangles than the source.
class StopsEarly final : public Solver {
public:
    explicit StopsEarly(const Options&) : good_(vertex_only()) {}

    void prepare(const Scene& scene, const Prepared& prepared) override {
        stops_ = element_count(scene.target) > element_count(scene.source);
        good_->prepare(scene, prepared);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        Result result = good_->solve(query, nullptr, trace);
        if (stops_) result.status = Status::time_limit, result.note = "stopped early", result.bounds.upper += 0.125;
        return result;
    }

private:
    bool stops_ = false;
    std::unique_ptr<Solver> good_;
};

class NeverReady final : public Solver {
public:
    explicit NeverReady(const Options&) {}
    void prepare(const Scene&, const Prepared&) override {
        for (;;) ::pause();
    }
    Result solve(const Query&, State*, Trace&) const override { return {}; }
};

SolverEntry never_ready() {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = "never_ready";
    return {info,
            [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<NeverReady>(options); }};
}

SolverEntry stops_early() {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = "stops_early";
    return {info,
            [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<StopsEarly>(options); }};
}

}  // namespace

HAUSBENCH_PLUGIN(vertex_only_solver(), spending_solver(), steps_solver(), misbehaving<crash>("crashes"),
                 misbehaving<hang>("hangs"), misbehaving<leave>("leaves"), never_ready(), never_returns(), floods(),
                 answers_once(), misbehaving<dawdle>("dawdles", {"up to there"}),
                 misbehaving<eat_memory>("eats_memory", {"bit by bit", "at once"}),
                 misbehaving<lie>("lies", {"upper below", "lower above", "far witness", "no such element", "crossed",
                                           "not a number", "wide", "wide, no cutoff", "false proof"}),
                 misbehaving<leak>("leaks", {"from repeat to repeat", "while it talks"}), stops_early(),
                 misbehaving<babble>("babbles", {"noise", "json", "another row", "an answer", "closed"}),
                 misbehaving<throw_it>("throws", {"an exception", "a number"}), misbehaving<chatter>("chatters"),
                 misbehaving<tell>("tells"))
