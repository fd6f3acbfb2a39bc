// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "server/api/app.h"
#include "server/serving/compute_pool.h"
#include "server/wire/http_message.h"
#include "server/wire/problem.h"

// Which work is taken on: a request is refused before its body is read when its answer would come too late.
namespace floorloc {

/// The label of a request's work. The deadline is that of the header X-Deadline-Ms, 1 to 60000 ms; without it, empty.
/// Throws Problem 400 invalid_parameter.
JobLabel MakeLabel(const HttpRequest& request, std::string client, WorkClass work);

/// Throws Overload "deadline" when the answer is expected after the label's deadline, or the configured one.
void RequireTime(const AppState& state, const JobLabel& label);

/// Runs a job in the compute pool and waits for it. Throws Overload when the queue is full, it waited too long or was
/// replaced, and rethrows the job's exception.
template <typename Job>
std::invoke_result_t<Job> RunInPool(AppState& state, const JobLabel& label, Job job) {
  auto future = state.pool.Submit(label, std::move(job));
  if (!future) {
    throw Overload("queue_full", "The queue of requests is full; try again in a moment.");
  }
  try {
    return future->get();
  } catch (const QueueTimeout&) {
    throw Overload("queue_timeout", "The request waited too long in the queue; try again in a moment.");
  } catch (const JobReplaced&) {
    throw Overload("replaced", "A newer image of this vehicle came before this one was localized.");
  }
}

}  // namespace floorloc
