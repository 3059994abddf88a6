// Events, in order: {"event":"prepared", ...}, then for each case "begin", "answer" (before anything is timed), "repeat" for
// each timed repeat, "trace", "end". "refused" instead of "prepared" if the solver cannot take the scene.
#include "worker.h"

#include "error.h"
#include "hash.h"
#include "memory.h"
#include "plugin.h"
#include "registry.h"
#include "session.h"
#include "shape_file.h"
#include "timing.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <iostream>
#include <iterator>

namespace hausbench {

using nlohmann::json;

namespace {

json pose_json(const Pose& pose) {
    json out = json::array();
    for (int i = 0; i < 9; ++i) out.push_back(number(pose.rotation(i / 3, i % 3)));
    for (int i = 0; i < 3; ++i) out.push_back(number(pose.translation[i]));
    return out;
}

Pose pose_of(const json& values) {
    Pose pose;
    for (int i = 0; i < 9; ++i) pose.rotation(i / 3, i % 3) = number(values.at(std::size_t(i)));
    for (int i = 0; i < 3; ++i) pose.translation[i] = number(values.at(std::size_t(9 + i)));
    return pose;
}

class Worker {
public:
    Worker(WorkOrder order, int events) : order_(std::move(order)), events_(events) {}

    int run() {
        const SolverEntry& entry = find_solver(order_.solver);
        Shape source = read_shape(order_.source_file).shape, target = read_shape(order_.target_file).shape;
        memory_.emplace();
        session_.emplace(entry, Options(order_.solver, entry.info.parameters, order_.options),
                         prepare_pair(entry.info, std::move(source), std::move(target)), order_.queries, order_.leave);
        memory_->prepared();
        json structures = json::array(), left_out = json::array();
        for (const PreparationTime& p : session_->preparation())
            structures.push_back({p.name, number(p.seconds), p.bytes});
        for (const Need& need : entry.info.may_need) {
            const auto& built = session_->needs();
            if (std::find(built.begin(), built.end(), need) == built.end()) left_out.push_back(to_string(need));
        }
        send({{"event", "prepared"}, {"structures", structures}, {"left_out", left_out}});
        for (const WorkOrder::Item& item : order_.items) answer(item);
        return 0;
    }

private:
    void send(const json& event) {
        const std::string line =
            event.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';  // a solver's words may be no UTF-8
        for (std::size_t done = 0; done < line.size();) {
            const ssize_t n = ::write(events_, line.data() + done, line.size() - done);
            if (n <= 0) std::exit(3);  // the runner is gone
            done += std::size_t(n);
        }
    }

    void answer(const WorkOrder::Item& item) {
        send({{"event", "begin"}, {"row", item.row}});
        Query query;
        query.source_pose = item.pose;
        query.tolerance = item.tolerance;
        query.floor = item.floor;
        query.cutoff = item.cutoff;
        if (item.budget >= 0) query.budget = std::uint64_t(item.budget);
        query.time_limit = order_.limits.case_seconds;

        memory_->next_answer();
        Trace untraced;
        const Stopwatch watch;
        Result result;
        Outcome outcome;
        try {
            result = session_->solve(query, untraced);
        } catch (const std::bad_alloc&) {
            give_up(item, RowStatus::out_of_memory, "the solver was refused memory that it asked for");
            return;
        } catch (const std::exception& error) {
            give_up(item, RowStatus::failed, std::string("the solver threw: ") + error.what());
            return;
        } catch (...) {
            give_up(item, RowStatus::failed, "the solver threw something that is not a std::exception");
            return;
        }
        const Spent spent = watch.spent();
        outcome.status = row_status(result.status);
        outcome.solver_status = to_string(result.status);
        if (outcome.status != RowStatus::ok)
            outcome.reason = result.note.empty() ? reason(result.status) : one_line(result.note);
        outcome.bounds = result.bounds;
        outcome.witness = result.witness;
        outcome.counters = result.counters;
        for (const auto& [name, value] : result.reported) {
            if (const auto* real = std::get_if<double>(&value))
                outcome.extras[one_line(name)] = *real;
            else
                outcome.facts[one_line(name)] = one_line(std::get<std::string>(value));
        }
        add_preparation(outcome);
        outcome.solve_seconds = spent.wall_seconds;
        outcome.answers.push_back({order_.round, spent.wall_seconds, spent.cpu_seconds, result.reported_seconds});
        outcome.clock = spent.several_threads ? "wall" : "cpu";
        outcome.reported_seconds = result.reported_seconds;
        outcome.peak_bytes = memory_->peak_bytes(result.outside_bytes);
        send({{"event", "answer"}, {"row", item.row}, {"outcome", to_json(outcome)}});

        if (outcome.status == RowStatus::ok || outcome.status == RowStatus::floor)
            time_repeats(item, query, spent.wall_seconds);
        if (item.trace) trace(item, query, result);
        send({{"event", "end"}, {"row", item.row}});
    }

    // No answer, and none to time; the solver may do better on the next case.
    void give_up(const WorkOrder::Item& item, RowStatus status, const std::string& reason) {
        Outcome outcome;
        outcome.status = status;
        outcome.reason = one_line(reason);
        add_preparation(outcome);
        send({{"event", "answer"}, {"row", item.row}, {"outcome", to_json(outcome)}});
        send({{"event", "end"}, {"row", item.row}});
    }

    void add_preparation(Outcome& outcome) const {
        outcome.prepare_seconds = session_->prepare_seconds();
        outcome.prepare_bytes = std::int64_t(session_->prepare_bytes());
        for (const PreparationTime& p : session_->preparation())
            outcome.preparation.push_back({order_.round, p.name, p.seconds, std::int64_t(p.bytes)});
    }

    std::string reason(Status status) const {
        switch (status) {
            case Status::time_limit:
                return fmt::format("not within {} s: the bounds hold", order_.limits.case_seconds);
            case Status::budget:
                return "the budget of subdivisions was spent: the bounds hold";
            case Status::precision_floor:
                return "the tolerance is below what double precision can certify: the bounds hold";
            case Status::stalled:
                return "the solver could not go on: the bounds hold";
            default:
                return "";
        }
    }

    // Fast solves are timed several at once, so that the clock's own cost stays below a thousandth.
    void time_repeats(const WorkOrder::Item& item, const Query& query, double first_seconds) {
        const auto iterations = std::int64_t(std::clamp(5e-4 / std::max(first_seconds, 1e-9), 1.0, 1000.0));
        double spent = 0;
        for (int i = 0; i < order_.repeats && (i == 0 || spent < 2 * order_.limits.case_seconds); ++i) {
            const Timing timing = time_once(*session_, query, iterations);
            spent += timing.wall_seconds * double(iterations);
            send({{"event", "repeat"},
                  {"row", item.row},
                  {"repeat", {order_.round, number(timing.wall_seconds), number(timing.cpu_seconds), iterations}}});
        }
    }

    void trace(const WorkOrder::Item& item, const Query& query, const Result& first) {
        Trace traced(Trace::Mode::on, item.marks);
        const Result again = session_->solve(query, traced);
        json samples = json::array();
        for (const TraceSample& s : traced.samples())
            samples.push_back({number(s.seconds), number(s.lower), number(s.upper)});
        // Only a run that both times came to its own end must come to the same one.
        const bool equal = again.bounds.lower == first.bounds.lower && again.bounds.upper == first.bounds.upper;
        send({{"event", "trace"},
              {"row", item.row},
              {"samples", samples},
              {"differs", !equal && again.status == Status::converged && first.status == Status::converged}});
    }

    WorkOrder order_;
    int events_;
    std::optional<SolverMemory> memory_;
    std::optional<Session> session_;
};

ParameterMap parameters_of(const json& object) {
    ParameterMap out;
    for (const auto& [name, value] : object.items()) out[name] = parameter_of(value);
    return out;
}

}  // namespace

json to_json(const WorkOrder& o) {
    json items = json::array(), plugins = json::object();
    for (const auto& [file, hash] : o.plugins) plugins[file.string()] = hash;
    for (const auto& i : o.items) {
        items.push_back({{"row", i.row},
                         {"pose", pose_json(i.pose)},
                         {"of_lower", i.tolerance.of == Tolerance::Of::lower},
                         {"tolerance", i.tolerance.value},
                         {"floor", i.floor},
                         {"cutoff", number(i.cutoff)},
                         {"budget", i.budget},
                         {"trace", i.trace},
                         {"marks", i.marks}});
    }
    return {{"solver", o.solver},
            {"options", options_json(o.options)},
            {"source", o.source_file.string()},
            {"target", o.target_file.string()},
            {"queries", {o.queries.moves, o.queries.count, o.queries.finest_tolerance}},
            {"limits", {o.limits.case_seconds, o.limits.prepare_seconds, o.limits.memory_bytes}},
            {"round", o.round},
            {"repeats", o.repeats},
            {"leave_nothing_out", o.leave == Leave::nothing_out},
            {"items", items},
            {"plugins", plugins}};
}

WorkOrder work_order_from_json(const json& j) {
    WorkOrder o;
    o.solver = j.at("solver");
    o.options = parameters_of(j.at("options"));
    o.source_file = j.at("source").get<std::string>();
    o.target_file = j.at("target").get<std::string>();
    o.queries = {j.at("queries").at(0), j.at("queries").at(1), j.at("queries").at(2)};
    o.limits = {j.at("limits").at(0), j.at("limits").at(1), j.at("limits").at(2)};
    o.round = j.at("round");
    o.repeats = j.at("repeats");
    o.leave = j.at("leave_nothing_out").get<bool>() ? Leave::nothing_out : Leave::out_what_is_not_needed;
    for (const json& i : j.at("items")) {
        o.items.push_back(
            {i.at("row"),
             pose_of(i.at("pose")),
             {i.at("of_lower").get<bool>() ? Tolerance::Of::lower : Tolerance::Of::absolute, i.at("tolerance")},
             i.at("floor"),
             number(i.at("cutoff")),
             i.at("budget"),
             i.at("trace"),
             i.at("marks").get<std::vector<double>>()});
    }
    for (const auto& [file, hash] : j.at("plugins").items()) o.plugins[file] = hash;
    return o;
}

int worker_main(int events) {
    ::fcntl(events, F_SETFD, FD_CLOEXEC);  // no business of programs that a solver starts
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    WorkOrder order = work_order_from_json(json::parse(text));
    for (const auto& [file, hash] : order.plugins) {
        if (sha256_of_file(file) != hash)
            throw InputError(fmt::format("{}: was built again while the sweep ran: run it again", file.string()));
        load_plugin(file);
    }
    return Worker(std::move(order), events).run();
}

}  // namespace hausbench
