// The kernels of rows.cl with a work-group for each row: for long rows in the wide form.
#define TEAM_IS_GROUP
#include "rows.cl"
