// The worker writes one event per line, such as {"event":"begin","row":3}. For each pair of shapes it sends "prepared"
// and then, for each case, "begin", "closer" for bounds on the way, "answer", "repeat" for each timed repeat, and "end". If they are requested,
// "trace", "fields" and "proof" come before "end". For a warm chain, the worker first answers all poses. Then it solves
// the whole chain again for each repeat, for the trace and for the fields. Finally, it sends "end" for every case.
#include "harness/run/worker.h"

#include "algorithms/error.h"
#include "algorithms/plugin.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/hash.h"
#include "datasets/shape_file.h"
#include "harness/ask/no_answer.h"
#include "harness/check/certificate_file.h"
#include "harness/check/verify_upper.h"
#include "harness/record/json.h"
#include "harness/result/field_file.h"
#include "harness/run/timing.h"
#include "process/listener.h"
#include "process/memory.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {

using nlohmann::json;

namespace {

// For the fields of a result, A is subdivided until linear interpolation between its vertices is off by at most a
// quarter of h(A,B) where this is tested (see Drawing), or until there are `most_pieces` pieces. The witness becomes a
// vertex, so that h(A,B) is among the values.
constexpr double resolution = 0.25;
constexpr std::size_t most_pieces = 100'000;

// Copies the values that a solver reports into the row: at most 1000, with 100,000 characters in names and texts. The
// fact `left out` says how many others there were.
void keep_reported(const Reported& reported, Outcome& outcome) {
    constexpr std::size_t most_values = 1000, most_characters = 100'000;
    std::size_t kept = 0, characters = 0, left_out = 0;
    for (const auto& [name, value] : reported) {
        const auto* real = std::get_if<double>(&value);
        const std::size_t length = name.size() + (real ? 0 : std::get<std::string>(value).size());
        if (kept == most_values || characters + length > most_characters) {
            ++left_out;
            continue;
        }
        ++kept;
        characters += length;
        if (real)
            outcome.extras[one_line(name)] = *real;
        else
            outcome.facts[one_line(name)] = one_line(std::get<std::string>(value));
    }
    if (left_out > 0)
        outcome.facts["left out"] = fmt::format("{} of {} reported values: a row keeps at most {}, with {} characters",
                                                left_out, reported.size(), most_values, most_characters);
}

class Worker {
public:
    Worker(WorkOrder order, int events) : order_(std::move(order)), events_(events) {}

    int run() {
        for (std::size_t i = 0; i < order_.items.size();) {
            open(order_.items[i].pair, i);
            for (const std::size_t end = order_.pair_end(i); i < end;) {
                const std::size_t last = order_.chain_end(i);
                if (order_.items[i].warm)
                    answer_chain(i, last);
                else
                    answer_cold(narrowed(order_.items[i]));
                i = last;
            }
        }
        return 0;
    }

private:
    // Returns the item. In a search, first lowers its cutoff to the smallest upper bound of the earlier answers.
    const WorkOrder::Item& narrowed(WorkOrder::Item& item) {
        if (item.search != search_) least_upper_ = std::numeric_limits<double>::infinity();
        search_ = item.search;
        if (item.search) item.narrow(least_upper_);
        return item;
    }

    void send(const json& event) {
        send_event(events_, event.dump(-1, ' ', false, json::error_handler_t::replace));  // text may not be UTF-8
    }

    // Loads the shapes of a pair if necessary, prepares the solver on them, and sends "prepared".
    void open(std::size_t number, std::size_t first) {
        const WorkOrder::Pair& pair = order_.pairs.at(number);
        const SolverEntry& entry = find_solver(order_.solver);
        const Options options(order_.solver, entry.info.parameters, order_.options, order_.folder);
        session_.reset();
        shapes_ = {};
        if (order_.scaled) {
            shapes_ = {shape(pair.source_file, first), shape(pair.target_file, first)};
            session_.emplace(entry, options, shapes_, pair.queries, order_.build);
        } else {
            Shape source = read_shape(pair.source_file).shape, target = read_shape(pair.target_file).shape;
            memory_.emplace();
            shapes_ = prepare_pair(entry.info, std::move(source), std::move(target));
            session_.emplace(entry, options, shapes_, pair.queries, order_.build);
            memory_->prepared();
        }
        json left_out = json::array();
        const auto& built = session_->needs();
        // Structures that were left out are reported only if no other direction, copy or pair may still build them.
        const bool alone = !order_.scaled && !pair.queries.symmetric && !pair.queries.target_moves;
        for (const Need& need : entry.info.may_need) {
            if (alone && std::find(built.begin(), built.end(), need) == built.end())
                left_out.push_back(to_string(need));
        }
        send({{"event", "prepared"}, {"left_out", left_out}});
    }

    // Returns a shape of a matrix, loading it if necessary. Releases shapes that no item from `first` on needs.
    std::shared_ptr<PreparedShape> shape(const std::filesystem::path& file, std::size_t first) {
        if (last_use_.empty()) {
            for (std::size_t i = 0; i < order_.items.size(); ++i) {
                const WorkOrder::Pair& pair = order_.pairs.at(order_.items[i].pair);
                last_use_[pair.source_file] = last_use_[pair.target_file] = i;
            }
        }
        std::erase_if(loaded_, [&](const auto& entry) { return last_use_.at(entry.first) < first; });
        auto& loaded = loaded_[file];
        if (!loaded) loaded = std::make_shared<PreparedShape>(read_shape(file).shape, order_.exponent);
        return loaded;
    }

    struct Answer {
        Result result;
        Spent spent;
        RowStatus status;
    };

    // Answers a case and sends the answer. Returns nothing if the solver threw or the session refused the pose.
    std::optional<Answer> answer(const WorkOrder::Item& item, State* state) {
        send({{"event", "begin"}, {"row", item.row}});
        if (memory_) memory_->next_answer();
        Trace trace;
        const auto closer = [&](const Result& so_far) {
            const Bounds& bounds = so_far.bounds;
            send({{"event", "closer"}, {"row", item.row}, {"bounds", {number(bounds.lower), number(bounds.upper)}}});
        };
        trace.watch(closer, Trace::pause);  // short answers send nothing
        const Stopwatch watch;
        Result result;
        if (const auto none = attempt([&] { result = session_->solve(item.query, state, trace); })) {
            if (none->why != NoAnswer::Why::refused) broke_ = true;  // else the session refused the pose
            return give_up(item, row_status(none->why), none->reason);
        }
        const Spent spent = watch.spent();
        Outcome outcome;
        outcome.status = row_status(result.status);
        outcome.solver_status = to_string(result.status);
        if (outcome.status != RowStatus::ok)
            outcome.reason = result.note.empty() ? reason(result.status) : one_line(result.note);
        outcome.cutoff_used = item.query.cutoff;
        outcome.bounds = result.bounds;
        least_upper_ = std::min(least_upper_, result.bounds.upper);
        outcome.witness = result.witness;
        outcome.counters = result.counters;
        keep_reported(result.reported, outcome);
        add_preparation(outcome);
        outcome.solve_seconds = spent.wall_seconds;
        outcome.answers.push_back({order_.round, spent.wall_seconds, spent.cpu_seconds, result.reported_seconds});
        outcome.clock = spent.by_wall ? "wall" : "cpu";
        outcome.reported_seconds = result.reported_seconds;
        if (memory_) outcome.peak_bytes = memory_->peak_bytes(result.outside_bytes);
        send({{"event", "answer"}, {"row", item.row}, {"outcome", to_json(outcome)}});
        return Answer{std::move(result), spent, outcome.status};
    }

    void answer_cold(const WorkOrder::Item& item) {
        if (const auto first = answer(item, nullptr)) {
            if (is_timed(first->status)) time_repeats(item, first->spent.wall_seconds);
            if (item.trace) trace(item, nullptr, first->result);
            fields(item, nullptr, first->result);
            if (item.query.wanted.certificate) prove(item, first->result);
        }
        send({{"event", "end"}, {"row", item.row}});
    }

    // Answers a warm chain. If the solver throws, its state is undefined, so later poses fail. Skips refused poses.
    void answer_chain(std::size_t begin, std::size_t end) {
        std::vector<std::optional<Answer>> first;
        std::unique_ptr<State> state = session_->begin();
        broke_ = false;
        for (std::size_t i = begin; i < end; ++i) {
            if (broke_) {
                send({{"event", "begin"}, {"row", order_.items[i].row}});
                first.push_back(
                    give_up(order_.items[i], RowStatus::failed, "the chain of poses broke at an earlier pose"));
            } else {
                first.push_back(answer(order_.items[i], state.get()));
            }
        }
        const auto pass = [&](auto&& at) {
            state = session_->begin();
            for (std::size_t i = begin; i < end; ++i) {
                if (first[i - begin]) at(order_.items[i], *first[i - begin]);
            }
        };
        double spent = 0;
        for (int k = 0; k < order_.repeats && (k == 0 || spent < most_seconds_of_repeats(end - begin)); ++k) {
            pass([&](const WorkOrder::Item& item, const Answer& answered) {
                Trace untraced;
                const Stopwatch watch;
                (void)session_->solve(item.query, state.get(), untraced);
                const Spent once = watch.spent();
                spent += once.wall_seconds;
                if (is_timed(answered.status)) repeated(item, {once.wall_seconds, once.cpu_seconds}, 1);
            });
        }
        if (order_.items[begin].trace)
            pass([&](const WorkOrder::Item& item, const Answer& answered) {
                trace(item, state.get(), answered.result);
            });
        pass([&](const WorkOrder::Item& item, const Answer& answer) { fields(item, state.get(), answer.result); });
        for (std::size_t i = begin; i < end; ++i) send({{"event", "end"}, {"row", order_.items[i].row}});
    }

    double most_seconds_of_repeats(std::size_t cases) const { return 2 * order_.limits.case_seconds * double(cases); }

    // Sends an outcome without bounds. Returns nullopt, which answer() passes on, so that nothing is timed.
    std::nullopt_t give_up(const WorkOrder::Item& item, RowStatus status, const std::string& reason) {
        Outcome outcome;
        outcome.status = status;
        outcome.reason = one_line(reason);
        outcome.cutoff_used = item.query.cutoff;
        add_preparation(outcome);
        send({{"event", "answer"}, {"row", item.row}, {"outcome", to_json(outcome)}});
        return std::nullopt;
    }

    void add_preparation(Outcome& outcome) const {
        outcome.prepare_seconds = session_->prepare_seconds();
        outcome.prepare_bytes = std::int64_t(session_->prepare_bytes());
        for (const PreparationTime& p : session_->preparation())
            outcome.preparation.push_back({order_.round, p.name, p.seconds, std::int64_t(p.bytes), p.shared ? 1 : 0});
    }

    std::string reason(Status status) const {
        switch (status) {
            case Status::time_limit:
                return fmt::format("not within {} s: the bounds hold", order_.limits.case_seconds);
            case Status::budget:
                return "the budget of subdivisions was spent: the bounds hold";
            case Status::precision_floor:
                return "the tolerance is smaller than double precision can certify: the bounds hold";
            case Status::stalled:
                return "the solver could not go on: the bounds hold";
            default:
                return "";
        }
    }

    // Times the repeats of a case. Times fast solves in batches of 0.5 ms, so that reading the clock costs < 0.1 %.
    void time_repeats(const WorkOrder::Item& item, double first_seconds) {
        const auto iterations = std::int64_t(std::clamp(5e-4 / std::max(first_seconds, 1e-9), 1.0, 1000.0));
        double spent = 0;
        for (int i = 0; i < order_.repeats && (i == 0 || spent < most_seconds_of_repeats(1)); ++i) {
            const Timing timing = time_once(*session_, item.query, iterations);
            spent += timing.wall_seconds * double(iterations);
            repeated(item, timing, iterations);
        }
    }

    void repeated(const WorkOrder::Item& item, const Timing& timing, std::int64_t iterations) {
        send({{"event", "repeat"},
              {"row", item.row},
              {"repeat", {order_.round, number(timing.wall_seconds), number(timing.cpu_seconds), iterations}}});
    }

    void trace(const WorkOrder::Item& item, State* state, const Result& first) {
        Trace traced(Trace::Mode::on, item.marks);
        const Result again = session_->solve(item.query, state, traced);
        json samples = json::array();
        for (const TraceSample& s : traced.samples())
            samples.push_back({number(s.seconds), number(s.lower), number(s.upper)});
        // A run that reaches a limit may stop anywhere, so the bounds must be equal only if both runs converged.
        const bool equal = again.bounds.lower == first.bounds.lower && again.bounds.upper == first.bounds.upper;
        send({{"event", "trace"},
              {"row", item.row},
              {"samples", samples},
              {"differs", !equal && again.status == Status::converged && first.status == Status::converged}});
    }

    // Writes a case's fields. Solves again if the solver has fields of its own, or if times of stages are requested.
    void fields(const WorkOrder::Item& item, State* state, const Result& first) {
        const bool wanted = !item.fields.empty();
        if (!wanted && !item.stages) return;
        json stages = json::object();
        Fields all;
        if (wanted) {
            Drawing drawing{resolution, first.bounds.lower};
            drawing.most_pieces = most_pieces;
            if (first.witness.direction == Witness::Direction::source_to_target) {
                drawing.witness = first.witness.source_point;
                drawing.witness_element = first.witness.source_element;
            }
            all = as_fields(draw_distance(*shapes_.source, item.query.source_pose, *shapes_.target,
                                          item.query.target_pose, drawing));
        }
        if (item.stages || find_solver(order_.solver).info.can(Ability::fields)) {
            Query query = item.query;
            query.wanted.fields = wanted;
            query.wanted.stages = true;
            Trace untraced;
            Result result = session_->solve(query, state, untraced);
            for (const auto& [name, value] : result.reported) {
                const auto* real = std::get_if<double>(&value);
                if (real && name.starts_with(stage_prefix)) stages[one_line(name)] = number(*real);
            }
            if (result.fields) add_own(all, std::move(*result.fields));
        }
        const std::string sha256 = wanted ? write_fields(item.fields, all) : "";
        send({{"event", "fields"}, {"row", item.row}, {"sha256", sha256}, {"stages", stages}});
    }

    // Checks an upper bound by the solver's certificate, or at every point of two point sets, and sends the verdict.
    void prove(const WorkOrder::Item& item, const Result& result) {
        const Query& query = item.query;
        const auto tell = [&](double proven, const std::string& certificate) {
            send({{"event", "proof"}, {"row", item.row}, {"proven", number(proven)}, {"certificate", certificate}});
        };
        const Shape source = as_loaded(*shapes_.source), target = as_loaded(*shapes_.target);
        if (kind_of(source) == ShapeKind::points && kind_of(target) == ShapeKind::points) {
            const UpperCheck check{query.quantity, result.bounds.upper, query.time_limit};
            const Verdict verdict = check.of_points(source, query.source_pose, target, query.target_pose);
            return tell(verdict == Verdict::holds ? check.upper : unknown, UpperCheck::words(verdict));
        }
        if (result.certificates.empty())
            return tell(unknown, result.why_no_certificate.empty() ? "none: the solver writes none"
                                                                   : "none: " + one_line(result.why_no_certificate));
        CertificateFile content;
        content.source.pose = query.source_pose;
        content.target.pose = query.target_pose;
        content.quantity = query.quantity;
        content.solver = order_.solver;
        take_answer(content, result, source, target);
        try {
            const CertificateVerdict verdict = verify_certificate(content, source, target);
            if (verdict.accepted)
                tell(std::max(verdict.proven, result.bounds.upper), "accepted");
            else
                tell(unknown, "refused: " + one_line(verdict.refusal));
        } catch (const std::exception& error) {
            tell(unknown, "not checked: " + one_line(error.what()));
        }
    }

    WorkOrder order_;
    int events_;
    bool broke_ = false;                                            // the solver threw, see answer_chain()
    std::size_t search_ = 0;                                        // the current search, see WorkOrder::Item
    double least_upper_ = std::numeric_limits<double>::infinity();  // smallest upper bound of the answers in it
    std::optional<PeakMemory> memory_;
    std::map<std::filesystem::path, std::shared_ptr<PreparedShape>> loaded_;  // shapes of a matrix
    std::map<std::filesystem::path, std::size_t> last_use_;                   // the last item that needs each shape
    PreparedPair shapes_;
    std::optional<Session> session_;
};

}  // namespace

int carry_out(WorkOrder order, int events) {
    for (const auto& [file, hash] : order.plugins) {
        if (sha256_of_file(file) != hash)
            throw InputError(fmt::format("{}: was rebuilt during the run: run it again", file.string()));
        load_plugin(file);
    }
    return Worker(std::move(order), events).run();
}

}  // namespace hausbench
