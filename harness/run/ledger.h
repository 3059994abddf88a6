// Completes the ledger after a run: what was left out, and the time saved.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/finished.h"

#include <vector>

namespace hausbench {

// Adds to the ledger of the plan: how long the rows that were read off others would have taken, and what structures that served
// several poses or pairs would have cost if they had been built for each.
void note_savings(const Plan& plan, const Finished& finished, const std::vector<Row>& rows,
                  std::vector<LedgerEntry>& ledger);

}  // namespace hausbench
