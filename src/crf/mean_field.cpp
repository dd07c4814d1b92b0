// SPDX-License-Identifier: BSD-3-Clause
#include "mean_field_engine.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>

namespace pcl_semantic {

MeanField::MeanField(CrfModel model, const Eigen::MatrixXf* initial)
{
  model.validate();
  engine_ = std::make_unique<Engine>(std::move(model), initial);
}

MeanField::~MeanField() = default;
MeanField::MeanField(MeanField&&) noexcept = default;
MeanField& MeanField::operator=(MeanField&&) noexcept = default;

double
MeanField::update()
{
  last_change_ = engine_->update();
  return last_change_;
}

int
MeanField::run(int max_updates, double settled)
{
  if (max_updates < 0)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "updates are " << max_updates << ", expected 0 or more");
  if (!(settled >= 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "the change of settled marginals is "
                                                       << settled
                                                       << ", expected 0 or more");
  for (int i = 1; i <= max_updates; ++i)
    if (update() <= settled && settled > 0.0)
      return i;
  return max_updates;
}

MeanField::Marginals
MeanField::marginals() const
{
  return engine_->marginals().view().topRows(engine_->marginals().rows());
}

Eigen::MatrixXf
MeanField::cliqueMarginals(std::size_t potential) const
{
  const PaddedColumns* const marginals = engine_->cliqueMarginals(potential);
  if (!marginals)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "clique potential " << potential
                                            << " has no variables of its own");
  return marginals->matrix();
}

double
MeanField::freeEnergy() const
{
  return engine_->freeEnergy();
}

} // namespace pcl_semantic
