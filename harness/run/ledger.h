// Completes the ledger, the list of work that was left out (LedgerEntry), with the time that this saved.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/finished.h"

#include <vector>

namespace hausbench {

// Adds to the ledger of a finished run the time that was saved because rows were read off the runs of others, and
// because structures were built once for all poses or pairs that use them.
void note_savings(const Plan& plan, const Finished& finished, const std::vector<Row>& rows,
                  std::vector<LedgerEntry>& ledger);

}  // namespace hausbench
