#include "harness/commands/measurement_solve.h"

#include "algorithms/error.h"
#include "algorithms/session/session.h"
#include "datasets/shape_file.h"
#include "harness/ask/in_child.h"
#include "harness/ask/json_values.h"
#include "harness/check/certificate_file.h"
#include "harness/commands/row_texts.h"
#include "harness/result/field_file.h"
#include "process/progress_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace hausbench {

using nlohmann::json;

namespace {

Query query_of(const MeasureRequest& request, const Tolerance& tolerance, const Measured& measured) {
    Query query;
    query.quantity = request.quantity();
    query.statistics = asked_statistics(request, measured.source.counted_by, measured.target.counted_by);
    query.weigh = request.weigh;
    query.share_tolerance = request.share_tolerance;
    query.tolerance = tolerance;
    query.threads = request.threads;
    query.time_limit = request.time_limit;
    query.budget = request.budget;
    if (measured.cutoff) query.floor = query.cutoff = *measured.cutoff;
    return query;
}

json json_of(const DrawnFile& drawn) {
    return {{"file", drawn.file.string()},      {"bounds", {number(drawn.bounds.lower), number(drawn.bounds.upper)}},
            {"largest", number(drawn.largest)}, {"vertices", drawn.vertices},
            {"pieces", drawn.pieces},           {"resolved", drawn.resolved}};
}

DrawnFile drawn_of(const json& j) {
    return {j.at("file").get<std::string>(),
            {number(j.at("bounds").at(0)), number(j.at("bounds").at(1))},
            number(j.at("largest")),
            j.at("vertices"),
            j.at("pieces"),
            j.at("resolved")};
}

// What the process that solves has: the sessions, and the files that it writes.
class Solving {
public:
    Solving(const MeasureRequest& request, const SolverEntry& entry, const Query& query, PreparedPair shapes)
        : request_(request), entry_(entry), query_(query), shapes_(std::move(shapes)) {
        const bool h = request.asks_for_h();
        forward_ = session(shapes_.source, shapes_.target, false);
        if (h && relative()) both_ = session(shapes_.source, shapes_.target, true);
        if (h) backward_ = session(shapes_.target, shapes_.source, false);
    }

    Opened open(const Query& query, bool backward) const {
        return {query.quantity == Quantity::symmetric ? both_ : backward ? backward_ : forward_};
    }

    // Writes A with its distances to B or, if `backward`, B with its distances to A. The witness becomes a vertex.
    DrawnFile write_fields(const Answer& answer, bool backward) const {
        const PreparedShape &from = backward ? *shapes_.target : *shapes_.source,
                            &to = backward ? *shapes_.source : *shapes_.target;
        const Result its = of_direction(answer, backward);
        const Witness& w = its.witness;
        const Drawing drawing{request_.resolution, its.bounds.lower, backward ? w.target_point : w.source_point,
                              backward ? w.target_element : w.source_element};
        const DrawnField drawn = draw_distance(from, {}, to, {}, drawing);
        const Fields solver_fields = own_fields(backward ? *backward_ : *forward_, answer);
        const auto file = backward ? file_of_way_back(request_.fields) : request_.fields;
        export_fields(file, drawn, solver_fields);
        return {file,
                its.bounds,
                drawn.largest(),
                std::int64_t(drawn.vertices.rows()),
                std::int64_t(drawn.pieces.rows()),
                drawn.resolved};
    }

    // Solves once more, and writes a certificate with the bounds of the new answer.
    json write_certificate(const std::string& tolerance_of) {
        Query query = query_;
        query.wanted.certificate = true;
        Result result =
            ask(
                query, [this](const Query& sub_query, bool back) { return open(sub_query, back); }, Directions::unknown)
                .result;
        if (result.certificates.empty()) return {{"why", one_line(result.why_no_certificate)}};
        CertificateFile content;
        content.source.file = request_.source.string();
        content.target.file = request_.target.string();
        content.quantity = query.quantity;
        content.solver = entry_.info.name;
        content.tolerance = request_.tolerance;
        content.tolerance_of = tolerance_of;
        take_answer(content, std::move(result), as_loaded(*shapes_.source), as_loaded(*shapes_.target));
        hausbench::write_certificate(request_.certificate, content);
        double proven = 0;
        for (const Certificate& certificate : content.certificates) proven = std::max(proven, certificate.proven);
        written_ = std::move(content);
        return {{"proven", number(proven)}};
    }

    // Returns why the written certificate may prove nothing; empty if its check passes, or if there is none.
    std::string doubt() const {
        if (!written_) return "";
        const CertificateVerdict verdict =
            verify_certificate(*written_, as_loaded(*shapes_.source), as_loaded(*shapes_.target));
        return verdict.accepted ? "" : one_line("its own check refuses this proof: " + verdict.refusal);
    }

private:
    bool relative() const { return query_.tolerance.of == Tolerance::Of::lower; }

    std::shared_ptr<const Session> session(const std::shared_ptr<PreparedShape>& a,
                                           const std::shared_ptr<PreparedShape>& b, bool symmetric) const {
        QuerySet queries;
        queries.finest_tolerance = relative() ? 0 : query_.tolerance.value;
        queries.symmetric = symmetric;
        queries.threads = query_.threads;
        queries.both_ways = std::any_of(query_.statistics.begin(), query_.statistics.end(), needs_target);
        const SolverInfo& info = entry_.info;
        return std::make_shared<const Session>(entry_, Options(info.name, info.parameters, request_.options),
                                               PreparedPair{a, b}, queries);
    }

    // Returns the answer for a direction. If it was not solved separately, returns the bounds that follow from H: 0 and
    // the upper bound of H.
    Result of_direction(const Answer& answer, bool backward) const {
        if (!request_.asks_for_h()) return answer.result;
        Result result;
        result.bounds.upper = answer.result.bounds.upper;
        return (backward ? answer.backward : answer.forward).value_or(result);
    }

    // Solves again for the solver's own fields, so that the measured time is the time for the bounds alone.
    Fields own_fields(const Session& session, const Answer& answer) const {
        if (!entry_.info.can(Ability::fields)) return {};
        Query query = query_;
        if (request_.asks_for_h()) query.quantity = Quantity::directed;
        query.wanted.fields = true;
        const double gap = query.tolerance.gap(answer.result.bounds.lower);
        if (relative() && gap > 0) query.tolerance = {Tolerance::Of::absolute, gap};
        Trace untraced;
        return session.solve(query, untraced).fields.value_or(Fields());
    }

    const MeasureRequest& request_;
    const SolverEntry& entry_;
    const Query& query_;
    PreparedPair shapes_;
    std::shared_ptr<const Session> forward_, both_, backward_;  // for h(A,B), H(A,B), h(B,A), as far as needed
    std::optional<CertificateFile> written_;
};

// Returns a line about what the solving process does.
std::string doing_text(const char* doing, const Answer* so_far, const MeasureRequest& request) {
    if (!so_far) return doing;
    const Bounds& bounds = so_far->result.bounds;
    const std::string name =
        request.statistics.empty() ? std::string(symbol(request.quantity())) : to_string(request.statistics.front());
    return fmt::format("{}, {} in [{}, {}] so far", doing, name, bound_text(bounds.lower, true),
                       bound_text(bounds.upper, false));
}

}  // namespace

void solve(const MeasureRequest& request, const SolverEntry& entry, const Tolerance& tolerance, Shape source,
           Shape target, Measured& measured) {
    std::unique_ptr<Solving> solving;  // exists only in the process that solves
    Question question;
    question.query = query_of(request, tolerance, measured);
    question.directions = Directions::known;
    question.prepare = [&]() -> OpenSession {
        solving = std::make_unique<Solving>(request, entry, question.query,
                                            prepare_pair(entry.info, std::move(source), std::move(target)));
        return [&](const Query& query, bool backward) { return solving->open(query, backward); };
    };
    std::size_t to_draw = 0;
    if (!request.fields.empty()) to_draw = request.asks_for_h() ? 2 : 1;
    for (std::size_t i = 0; i < to_draw; ++i)
        question.steps.push_back(
            {"its fields were not written",
             [&, i](const Answer& answer) { return json_of(solving->write_fields(answer, i == 1)); },
             [&](const json& report) { measured.drawn.push_back(drawn_of(report)); }});
    if (!request.certificate.empty()) {
        question.steps.push_back({"its certificate was not written",
                                  [&](const Answer&) { return solving->write_certificate(measured.tolerance_of); },
                                  [&](const json& report) {
                                      if (report.contains("why"))
                                          measured.why_not_proven = report.at("why");
                                      else
                                          measured.proven = number(report.at("proven"));
                                  }});
        question.steps.push_back({"its certificate was not checked",
                                  [&](const Answer&) { return json(solving->doubt()); },
                                  [&](const json& report) { measured.doubt = report; }});
    }
    Answered all;
    if (request.in_process) {
        all = ask_here(question);
    } else {
        ProgressLine progress;
        AskLimits limits;
        limits.seconds = request.time_limit;
        limits.waiting = [&](const char* doing, const Answer* so_far) {
            progress.draw(doing_text(doing, so_far, request));
        };
        all = ask_in_child(question, limits);
    }
    measured.answer = std::move(all.answer);
    measured.peak_bytes = all.peak_bytes;
    measured.failed = std::move(all.no_answer);
    if (all.steps == question.steps.size()) return;
    if (all.steps < to_draw) measured.why_not_drawn = all.why_not_all;
    if (all.steps <= to_draw && !request.certificate.empty())
        measured.why_not_proven = all.why_not_all;
    else if (measured.proven)
        measured.doubt = "it was not checked: " + all.why_not_all;
}

}  // namespace hausbench
